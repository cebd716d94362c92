"""Every small file of ours, spoiled in every way that text is: read all the same, or one line."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.cuts import CutRules
from prunus.errors import PrunusError
from prunus.files.reading import short, text_of
from prunus.io.labels import read_labels
from prunus.io.rig import read_rig
from prunus.io.skeletons.plans import read_plan
from prunus.io.skeletons.skeleton_file import read_skeleton, write_skeleton
from prunus.params import Parameters
from prunus.session.journal import read_journal
from tests.drawn import tree
from tests.io.skeletons.test_plans import PLAN
from tests.io.skeletons.test_skeletons import random_skeleton
from tests.io.test_labels import HEAD as LABEL_HEAD
from tests.session.test_journal import HEAD


def skeleton_text() -> str:
    record: dict[str, Any] = {
        "nodes": [[0, 0, 0], [0, 0, 0.5]], "parent": [-1, 0], "label": ["trunk", "trunk"],
        "confidence": [None, 0.5], "radius": [0.02, None], "superpoint": [0, 1], "seed": 3,
        "params": {"search": {"K": 500}},
    }  # fmt: skip
    return json.dumps(record)


def rig_text() -> str:
    turn = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    view = {"cloud": "é.npy", "rotation": turn, "translation": [0, 0, 0], "fx": 500.5}
    record = {"format": "prunus-rig", "version": 1, "unit": "m", "views": [view]}
    return json.dumps(record, ensure_ascii=False)


def read_rig_of(path: Path) -> object:
    np.save(path.parent / "é.npy", np.eye(3))
    return read_rig(path.parent)


@dataclass(frozen=True)
class Kind:
    """A kind of file: what it is called, a good one, and a number in it that can be spoiled."""

    name: str
    good: str
    read: Callable[[Path], object]
    number: str = ""

    def __str__(self) -> str:
        return self.name


PARAMS = 'method = "paper"\n[search]\nrefine = false\nK = 7 # ü\n'

KINDS = [
    Kind("params.toml", PARAMS, Parameters.from_toml, "K = 7"),
    Kind("rules.toml", "[height]\nover = 2.5 # ü\n", CutRules.from_toml, "over = 2.5"),
    Kind("skeleton.json", skeleton_text(), read_skeleton, '"seed": 3'),
    Kind("plan.json", json.dumps(PLAN), read_plan, '"confidence": 0.97'),
    Kind("rig.json", rig_text(), read_rig_of, '"fx": 500.5'),
    Kind("journal.jsonl", json.dumps(HEAD.model_dump()) + "\n", read_journal, '"seed": 0'),
    Kind("labels.jsonl", json.dumps(LABEL_HEAD.model_dump()) + "\n", read_labels, '"seed": 0'),
]
JSON = [kind for kind in KINDS if "json" in kind.name]
kinds = pytest.mark.parametrize("kind", KINDS, ids=str)


def refusal(kind: Kind, path: Path) -> str:
    """What is said of a file, which is one line that names it."""
    with pytest.raises(PrunusError) as raised:
        kind.read(path)
    said = str(raised.value)
    assert said.startswith(str(path)) and "\n" not in said and len(said) < 600
    return said


@kinds
def test_a_byte_order_mark_is_read_as_if_it_were_not_there(kind: Kind, tmp_path: Path) -> None:
    path = tmp_path / kind.name
    path.write_text(kind.good, encoding="utf-8")
    plain = kind.read(path)
    path.write_text(kind.good, encoding="utf-8-sig")
    marked = kind.read(path)
    if kind.name == "skeleton.json":
        assert np.array_equal(plain.xyz, marked.xyz)  # type: ignore[attr-defined]
    elif kind.name == "journal.jsonl":
        assert plain.head == marked.head  # type: ignore[attr-defined]
    elif kind.name != "rig.json":
        assert plain == marked


@kinds
@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be", "utf-32", "utf-16-le"])
def test_other_encodings_are_refused_in_words(kind: Kind, tmp_path: Path, encoding: str) -> None:
    path = tmp_path / kind.name
    path.write_bytes(kind.good.encode(encoding))
    assert "UTF-8" in refusal(kind, path)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind.good.isascii()], ids=str)
def test_an_old_code_page_is_refused_by_its_byte(kind: Kind, tmp_path: Path) -> None:
    path = tmp_path / kind.name
    path.write_text(kind.good, encoding="cp1252")
    assert "is no UTF-8" in refusal(kind, path)


@kinds
@pytest.mark.parametrize(
    "value",
    ["true", '"3"', "[1]", "1e999", "-" + "9" * 5000, "nan", "NaN", "inf", "-Infinity"],
)
def test_a_number_that_is_none_is_refused(kind: Kind, tmp_path: Path, value: str) -> None:
    path = tmp_path / kind.name
    spoiled = kind.good.replace(kind.number, kind.number[: kind.number.rindex(" ") + 1] + value)
    assert spoiled != kind.good
    path.write_text(spoiled, encoding="utf-8")
    refusal(kind, path)


@pytest.mark.parametrize("kind", JSON, ids=str)
def test_a_key_that_stands_twice_is_refused(kind: Kind, tmp_path: Path) -> None:
    path = tmp_path / kind.name
    first = next(iter(json.loads(kind.good)))
    path.write_text(kind.good.replace("{", f'{{"{first}": 1, ', 1), encoding="utf-8")
    assert f"the key '{first}' stands twice" in refusal(kind, path)


@pytest.mark.parametrize("kind", JSON, ids=str)
@pytest.mark.parametrize("deep", [150, 300, 985, 100_000])
def test_deep_nesting_is_refused(kind: Kind, tmp_path: Path, deep: int) -> None:
    path = tmp_path / kind.name
    path.write_text('{"input": ' + "[" * deep + "]" * deep + "}\n", encoding="utf-8")
    refusal(kind, path)


@pytest.mark.parametrize("kind", JSON, ids=str)
@pytest.mark.parametrize("text", ["[]", "3", '"skeleton"', "null", "{}", '{"input": 3}'])
def test_json_of_another_shape_is_refused(kind: Kind, tmp_path: Path, text: str) -> None:
    path = tmp_path / kind.name
    path.write_text(text + "\n")
    if kind.name == "plan.json" and text == "{}":
        assert "cuts: missing" in refusal(kind, path)
    refusal(kind, path)


@kinds
def test_a_name_that_nobody_knows_is_told(kind: Kind, tmp_path: Path) -> None:
    path = tmp_path / kind.name
    named = "colour = 1\n" + kind.good if "toml" in kind.name else kind.good
    path.write_text(named.replace("{", '{"colour": 1, ', 1), encoding="utf-8")
    assert "colour: unknown" in refusal(kind, path)


@kinds
@settings(deadline=None, max_examples=60)
@given(data=st.data())
def test_any_damage_is_read_or_refused(
    kind: Kind, tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    content = bytearray(kind.good.encode())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at : at + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=3))
    path = tmp_path_factory.mktemp("spoiled") / kind.name
    path.write_bytes(bytes(content))
    try:
        kind.read(path)
    except PrunusError as error:
        assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("column", "value", "says"),
    [
        ("confidence", 1.2, "confidence.1: input should be less than or equal to 1"),
        ("confidence", -0.1, "confidence.1: input should be greater than or equal to 0"),
        ("radius", -0.01, "radius.1: input should be greater than or equal to 0"),
        ("radius", np.inf, "radius.1: input should be a finite number"),
    ],
)
def test_what_cannot_be_is_not_written_either(
    column: str, value: float, says: str, tmp_path: Path
) -> None:
    from dataclasses import replace

    drawn = tree()
    values = np.full(len(drawn), 0.5)
    values[1] = value
    with pytest.raises(PrunusError, match=says):
        write_skeleton(tmp_path / "s.json", replace(drawn, **{column: values}))
    assert not (tmp_path / "s.json").exists()


def test_what_is_shown_of_a_value_is_short_whatever_it_is() -> None:
    deep: list[Any] = []
    for _ in range(5000):
        deep = [deep]
    for value in (deep, "x" * 10**6, list(range(10**5)), {"a\nb": 1}, random_skeleton(0)):
        assert len(short(value)) <= 60 and "\n" not in short(value)


def test_old_comments_are_no_reason_to_refuse() -> None:
    assert text_of("# Wäldchen\n".encode("latin-1"), "a.swc", lenient=True).startswith("# W")
