"""The report: one file, no network, with all that it promises."""

import json
import re
from html import escape
from pathlib import Path

import numpy as np
import pytest

from prunus.cuts import Plan, plan_cuts
from prunus.model.branches import branches
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.report import report_page
from prunus.report.cuts import cut_traces
from prunus.report.scene import scene_traces
from prunus.result import Result
from tests.conftest import simulated

GAP = (None, None, None)


@pytest.fixture(scope="module")
def found() -> Result:
    truth, cloud = simulated(2)
    return skeletonize(cloud, truth.xyz[0])


@pytest.fixture(scope="module")
def page(found: Result) -> str:
    return report_page(found, "tree <2>", ["frame z-up: a note"])


def test_the_page_asks_nothing_of_the_network(page: str) -> None:
    outside = re.sub(r"<script>/\*\*.*?</script>", "", page, count=1, flags=re.DOTALL)
    assert len(outside) < len(page) / 2, "the library is inside"
    assert not re.search(r"(src|href)=", outside)


def test_names_are_escaped_and_notes_and_warnings_shown(page: str, found: Result) -> None:
    assert "tree &lt;2&gt;" in page and "tree <2>" not in page
    assert "frame z-up: a note" in page
    assert all(escape(reason) in page for reason in found.review)


def test_the_scene_has_a_switch_for_every_piece_of_evidence(page: str) -> None:
    scene = re.search(r'newPlot\("scene", (\[.*?\]), \{"margin"', page)
    assert scene is not None
    traces = json.loads(scene.group(1))
    names = [trace["name"] for trace in traces]
    assert names[:7] == ["cloud", "trunk", "support", "leader", "side branch", "base", "tips"]
    hidden = {trace["name"] for trace in traces if trace["visible"] == "legendonly"}
    assert "superpoints" in hidden and "refined" in hidden
    assert sum(name.startswith("candidates, confidence") for name in hidden) == 3


def test_the_refined_skeleton_is_in_the_scene_branch_by_branch(found: Result) -> None:
    fine = found.refined.skeleton
    traces = scene_traces(found.in_house, fine, found.graph)
    (line,) = [trace for trace in traces if trace["name"] == "refined"]
    ends = [k for k, value in enumerate(line["x"]) if value is None]
    assert len(ends) == len(branches(fine)) and ends[-1] == len(line["x"]) - 1
    drawn = {(x, y, z) for x, y, z in zip(line["x"], line["y"], line["z"], strict=True)} - {GAP}
    assert drawn == {tuple(row) for row in np.round(fine.xyz, 4).tolist()}
    assert len(line["text"]) == len(line["x"])
    assert sum(text.endswith("mm thick") for text in line["text"]) > len(fine) / 2


def test_a_tree_of_one_node_has_no_refined_lines(found: Result) -> None:
    alone = found.in_house.part(np.arange(len(found.in_house)) == 0)
    (line,) = [
        trace for trace in scene_traces(alone, alone, found.graph) if trace["name"] == "refined"
    ]
    assert line["x"] == [None]


def test_tables_hold_leaders_times_and_parameters(page: str, found: Result) -> None:
    for text in ("Leaders, from left to right", "Time by stage", "raw_from = 0.08"):
        assert text in page
    assert f"{len(found.graph.xyz)} nodes on the axes of branches" in page
    assert "Score" not in page.rpartition("</style>")[2].partition("<h1>")[2]


def test_a_method_that_goes_by_a_score_has_it_on_its_page() -> None:
    truth, cloud = simulated(2)
    found = skeletonize(cloud, truth.xyz[0], Parameters.paper().changed("search", K=20))
    page = report_page(found, "tree")
    assert "Score by iteration" in page and "r_super = 0.1" in page
    assert f"Score {found.score:.2f}" in page
    assert f"({found.graph.superpoints.unused_points:,} in no superpoint)" in page


def test_a_page_is_a_few_megabytes(page: str, tmp_path: Path) -> None:
    assert 3e6 < len(page) < 9e6


def test_a_plan_has_its_blades_in_the_scene_and_a_table(found: Result) -> None:
    plan = plan_cuts(found.refined, found.scan.xyz)
    page = report_page(found, "tree.ply", plan=plan)
    traces = cut_traces(plan)
    blades = [trace for trace in traces if trace["type"] == "mesh3d"][:-1]
    assert sum(len(trace["x"]) for trace in blades) == 21 * len(plan.cuts)
    assert all(max(trace["k"]) < len(trace["x"]) for trace in blades)
    assert all(f"<td>{cut.branch}</td>" in page for cut in plan.cuts)
    assert all(escape(f"{one.branch}: {one.why}") in page for one in plan.left)
    assert cut_traces(Plan((), (), plan.rules)) == []
