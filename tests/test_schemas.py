"""The schemas that ship: current, named, and what the command line prints keeps to them."""

import json
from pathlib import Path

import jsonschema
import pytest
from jsonschema.validators import Draft202012Validator

import prunus as package
from prunus.errors import PrunusError, Status
from prunus.io.skeletons.skeleton_file import write_skeleton
from prunus.schemas import ABOUT, HOME, schema, text_of
from prunus.schemas.make import made
from tests.drawn import tree
from tests.test_cli import prunus

REMAKE = "python -m prunus.schemas.make"


@pytest.mark.parametrize("name", ABOUT)
def test_a_schema_is_valid_current_and_has_a_name_of_its_own(name: str) -> None:
    assert text_of(name) == made(name), REMAKE
    held = schema(name)
    Draft202012Validator.check_schema(held)
    assert held["$schema"].endswith("2020-12/schema")
    assert held["$id"] == f"urn:prunus:schema:{name}:{held['version']}"
    assert held["title"].startswith("prunus: ")
    assert prunus("schema", name).stdout == text_of(name)


def test_each_file_beside_them_is_one_and_all_are_listed() -> None:
    assert {path.stem for path in HOME.glob("*.json")} == set(ABOUT), REMAKE
    listed = [line.split()[0] for line in prunus("schema").stdout.splitlines()]
    assert listed == list(ABOUT)


def test_an_unknown_name_is_answered_with_those_there_are() -> None:
    with pytest.raises(PrunusError, match=r"'tree'.*skeleton, plan"):
        package.schema("tree")
    assert prunus("schema", "tree").exit_code == Status.WRONG_COMMAND


def test_skeletons_and_plans_keep_to_their_schema(tmp_path: Path) -> None:
    write_skeleton(tmp_path / "s.json", tree(), score=1.0, review=[])
    jsonschema.validate(json.loads((tmp_path / "s.json").read_text()), schema("skeleton"))
    done = prunus("cuts", tmp_path / "s.json", "-o", tmp_path / "plan.json", "--json")
    jsonschema.validate(json.loads(done.stdout), schema("plan"))
    jsonschema.validate(json.loads((tmp_path / "plan.json").read_text()), schema("plan"))


@pytest.mark.parametrize("ending", [".json", ".swc", ".ply"])
def test_the_line_of_evaluate_keeps_to_its_schema(ending: str, tmp_path: Path) -> None:
    write_skeleton(tmp_path / "s.json", tree())
    write_skeleton(tmp_path / "bare.json", tree().with_radius([0.01] * len(tree())))
    prunus("convert", tmp_path / "bare.json", tmp_path / f"t{ending}")
    done = prunus("evaluate", tmp_path / "s.json", tmp_path / f"t{ending}", "--json")
    record = json.loads(done.stdout)
    jsonschema.validate(record, schema("evaluate"))
    assert record["geometry_recall"] == 1
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(record | {"edges": "many"}, schema("evaluate"))


def test_a_line_that_lacks_a_field_or_has_another_is_none() -> None:
    line = dict.fromkeys(schema("skeletonize")["required"])
    line |= {"file": "a.ply", "ok": False, "error": "why", "review": [], "warnings": []}
    jsonschema.validate(line, schema("skeletonize"))
    for wrong in ({**line, "colour": 1}, {"file": "a.ply"}, {**line, "ok": "no"}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(wrong, schema("skeletonize"))


def test_every_status_is_in_its_schema_and_no_other() -> None:
    for status in Status:
        jsonschema.validate(int(status), schema("status"))
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(3, schema("status"))
