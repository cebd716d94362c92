"""Records of measures as CSV, and as JSON has them."""

from __future__ import annotations

import csv
import io
import math
from typing import Any


def csv_bytes(records: list[dict[str, Any]]) -> bytes:
    """A row a record, a column a name that any of them has; empty where one has none."""
    held = io.StringIO()
    names = list(dict.fromkeys(name for record in records for name in record))
    writer = csv.DictWriter(held, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    return held.getvalue().encode()


def without_nan(record: dict[str, Any]) -> dict[str, Any]:
    """The record with None in place of NaN."""
    return {
        name: None if isinstance(value, float) and math.isnan(value) else value
        for name, value in record.items()
    }
