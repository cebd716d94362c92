"""Plans to files and back; the schema; files that lie."""

import json
from pathlib import Path

import jsonschema
import pytest

from prunus.errors import PrunusError
from prunus.io.skeletons.plans import PlanFile, read_plan, write_plan
from prunus.schemas import schema

CUT = {
    "id": "side_branches:side-branch-1", "branch": "side branch 1", "rule": "side_branches",
    "because": "0.29 m long, over 0.15 m", "point": [0.03, 0, 0.5], "blade_normal": [1, 0, 0],
    "branch_direction": [1, 0, 0],
    "approach": {"direction": [0, 1, 0], "half_angle_deg": 31.5, "free_within_m": 0.3},
    "diameter": 0.01, "diameter_error": None, "stub_length": 0.02,
    "wood_removed": {"length": 0.27, "volume": 2.1e-5},
    "confidence": 0.97, "needs_review": False, "reasons": [],
}  # fmt: skip
PLAN = {
    "cuts": [CUT],
    "left": [{"rule": "height", "branch": "leader 1", "why": "0.40 m over the support"}],
    "rules": {"side_branches": {"longer_than": 0.15}},
    "skeleton": "skeleton.json",
}


def test_a_plan_reads_back_as_it_was_written(tmp_path: Path) -> None:
    plan = PlanFile.model_validate(PLAN)
    write_plan(tmp_path / "plan.json", plan)
    assert read_plan(tmp_path / "plan.json") == plan
    jsonschema.validate(json.loads((tmp_path / "plan.json").read_text()), schema("plan"))


@pytest.mark.parametrize(
    ("field", "value", "named"),
    [
        ("rule", "trunks", "cuts.0.rule"), ("confidence", 1.2, "cuts.0.confidence"),
        ("diameter", -1, "cuts.0.diameter"), ("colour", "red", "cuts.0.colour"),
        ("point", [0, 1], "cuts.0.point"),
    ],
)  # fmt: skip
def test_files_that_lie_are_refused_by_field(
    field: str, value: object, named: str, tmp_path: Path
) -> None:
    (tmp_path / "plan.json").write_text(json.dumps(PLAN | {"cuts": [CUT | {field: value}]}))
    with pytest.raises(PrunusError, match=r"plan\.json") as error:
        read_plan(tmp_path / "plan.json")
    assert named in str(error.value)
