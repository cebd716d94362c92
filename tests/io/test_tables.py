"""Records as tables: what is written reads back, and what is missing is said."""

import csv
import io
import sys

import pytest

from prunus.errors import PrunusError
from prunus.io.tables import csv_bytes, parquet_bytes, without_nan

RECORDS = [
    {"name": "leader 1", "count": 3, "length_m": 1.25},
    {"name": "leader 2", "count": None, "length_m": None},
]
COLUMNS = {"name": str, "count": int, "length_m": float}


def test_csv_has_the_columns_that_are_asked_for() -> None:
    rows = list(csv.DictReader(io.StringIO(csv_bytes(RECORDS, list(COLUMNS)).decode())))
    assert list(rows[0]) == list(COLUMNS)
    assert rows[0] == {"name": "leader 1", "count": "3", "length_m": "1.25"}
    assert rows[1]["count"] == "" and rows[1]["length_m"] == ""


def test_a_table_without_records_still_has_its_columns() -> None:
    assert csv_bytes([], list(COLUMNS)) == b"name,count,length_m\n"


def test_parquet_reads_back_with_its_types() -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    table = parquet.read_table(io.BytesIO(parquet_bytes(RECORDS, COLUMNS)))
    assert [str(kind) for kind in table.schema.types] == ["string", "int64", "double"]
    assert table.to_pylist() == RECORDS


def test_without_pyarrow_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(PrunusError, match=r"pip install 'prunus\[tables\]'"):
        parquet_bytes(RECORDS, COLUMNS)


def test_what_is_not_a_number_is_none() -> None:
    assert without_nan({"a": float("nan"), "b": 2.0, "c": "x"}) == {"a": None, "b": 2.0, "c": "x"}
