"""Records of measures as CSV, and as JSON has them."""

from __future__ import annotations

import csv
import io
import math
from typing import Any

from prunus.errors import PrunusError


def csv_bytes(records: list[dict[str, Any]], names: list[str] | None = None) -> bytes:
    """A row a record, a column a name (those that any record has); empty where it has none."""
    held = io.StringIO()
    names = names or list(dict.fromkeys(name for record in records for name in record))
    writer = csv.DictWriter(held, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    return held.getvalue().encode()


def parquet_bytes(records: list[dict[str, Any]], columns: dict[str, type]) -> bytes:
    """The records as Parquet: columns of str, int or float; null where a record has None.

    Raises PrunusError where pyarrow is not installed.
    """
    try:
        import pyarrow as arrow
        from pyarrow import parquet
    except ImportError as error:
        raise PrunusError("Parquet needs pyarrow: pip install 'prunus[tables]'") from error
    kinds = {str: arrow.string(), int: arrow.int64(), float: arrow.float64()}
    schema = arrow.schema([(name, kinds[kind]) for name, kind in columns.items()])
    held = io.BytesIO()
    parquet.write_table(arrow.Table.from_pylist(records, schema=schema), held)
    return held.getvalue()


def without_nan(record: dict[str, Any]) -> dict[str, Any]:
    """The record with None in place of NaN."""
    return {
        name: None if isinstance(value, float) and math.isnan(value) else value
        for name, value in record.items()
    }
