"""The paper's method, whole: what each of its numbers does, and the tree that it is run on."""

from functools import cache

import numpy as np
import pytest

from prunus.model import Kind
from prunus.params import GROUPS, Parameters
from prunus.pipeline import follow
from prunus.result import Result
from tests.conftest import field_scan, simulated

FEW = Parameters.paper().changed("search", K=40)
OTHER: dict[str, dict[str, object]] = {
    "input": {"points": 5_000},
    "isolation": {"isolate": "always", "raw_from": 0.999},
    "superpoints": {"r_super": 0.08, "min_points": 60},
    "confidence": {"alpha_conf": 0.8},
    "tips": {"alpha_tip": 0.1},
    "turn": {"theta": 0.05, "c": 4.0, "p": 0.5},
    "grow": {"theta": 0.05, "c": 4.0, "p": 0.2},
    "search": {"K": 3, "k_max_rep": 1},
    "side_branches": {"angle_min": 1.5, "angle_max": 1.6, "turn_max": 0.05},
}


@cache
def found(params: Parameters, tree: int) -> Result:
    truth, cloud = simulated(tree)
    return follow(cloud, truth.xyz[0], params)


def changed(group: str, key: str, tree: int) -> bool:
    before = FEW if key != "raw_from" else FEW.changed("isolation", isolate="auto", raw_from=1e-6)
    after = before.changed(group, **{key: OTHER[group][key]})
    one, other = found(before, tree), found(after, tree)
    kept = [result.tree_cloud.xyz.shape for result in (one, other)]
    return kept[0] != kept[1] or not np.array_equal(one.skeleton.xyz, other.skeleton.xyz)


SHOWN = [(g, k) for g in GROUPS["paper"] for k in getattr(FEW, g).model_dump()]


def test_no_parameter_is_forgotten() -> None:
    assert [(g, k) for g in OTHER for k in OTHER[g]] == SHOWN


@pytest.mark.parametrize(("group", "key"), SHOWN)
def test_each_parameter_that_is_shown_changes_some_result(group: str, key: str) -> None:
    assert any(changed(group, key, tree) for tree in (2, 4, 5, 6))


def test_where_it_is_asked_for_the_tree_of_the_default_is_taken() -> None:
    scan = field_scan(4)
    cloud, base = scan.cloud(), scan.truth.xyz[0]
    alone = FEW.changed("isolation", isolate="always")
    as_many = Parameters().changed("input", points=alone.input.points)
    result, default = follow(cloud, base, alone), follow(cloud, base, as_many)
    assert result.isolated is not None and default.isolated is not None
    assert np.array_equal(result.isolated.kind, default.isolated.kind)
    assert (result.isolated.kind == Kind.TARGET).sum() == len(result.tree_cloud)
    assert len(result.graph.superpoints.cloud) <= len(result.tree_cloud)
    assert any("a raw scan" in note for note in result.notes)
    assert follow(cloud, base, FEW).isolated is None
