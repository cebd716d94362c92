"""Trees that a person corrected as truth: what was drawn, what was marked, and what nobody said."""

from pathlib import Path
from shutil import copytree

import numpy as np
import pytest

from prunus.editing import Box, Mark, SetStatus
from prunus.io.clouds.cloud_file import write_cloud
from prunus.io.skeletons.skeleton_file import read_record, write_skeleton
from prunus.lab.experiment.gold import corrected_in
from prunus.lab.learn.field.corrected import corrected_example
from prunus.lab.learn.field.examples import FieldExample, lesson_of
from prunus.lab.simulate import simulate_scan
from prunus.lab.simulate.wide.points import UNTOLD, point_truth
from prunus.model import Kind, Label, Role
from prunus.session import Settings, Work

TREE = simulate_scan(4, "clean")
OWN = TREE.kind == Kind.TARGET
XYZ, TRUE = TREE.xyz[OWN], point_truth(TREE)
HIGH, HIGHEST = np.percentile(XYZ[:, 2], [90, 95]).tolist()
"""Above these a person marked a neighbour, and a wire."""
ALL = Box((-9.0, -9.0, -9.0), (9.0, 9.0, 9.0))


def above(height: float) -> Box:
    return Box((-9.0, -9.0, height), (9.0, 9.0, 9.0))


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A work folder in which a person left the true tree, after marking its top as a wire."""
    root = tmp_path_factory.mktemp("corrected")
    write_cloud(root / "scans" / "tree.ply", XYZ)
    folder = root / "work" / "tree"
    with Work.open(root / "scans" / "tree.ply", folder, Settings(frame="z-up")) as own:
        record = own.scan.record
        own.do(Mark(above(HIGH), Kind.NEIGHBOUR))
        own.do(Mark(above(HIGHEST), Kind.WIRE))
        own.do(Mark(ALL, Kind.STRAY))
        own.undo()
        own.do(SetStatus(True))
    write_skeleton(folder / "corrected.json", TREE.truth, input=record)
    return root / "work"


def example_in(work: Path, scans: Path) -> FieldExample:
    (subject,), _ = corrected_in(work, scans)
    return corrected_example(subject)


@pytest.fixture(scope="module")
def example(work: Path) -> FieldExample:
    return example_in(work, work.parent / "scans")


def test_points_near_what_was_drawn_have_its_truth(example: FieldExample) -> None:
    told, role = example.truth, TRUE.role[OWN]
    thick = (told.role >= 0) & (told.role != Role.NO_WOOD) & (role < Role.LATERAL)
    assert thick.sum() > 0.95 * ((role < Role.LATERAL) & (XYZ[:, 2] < HIGH)).sum()
    assert (told.role == role)[thick].mean() > 0.93
    away = told.axis - example.xyz - (TRUE.axis[OWN] - XYZ)
    fine = thick & (role > Role.STEM)  # a stem seen from one side is fitted a centimetre off
    assert np.median(np.linalg.norm(away[fine], axis=1)) < 0.005
    cosine = (told.toward_foot * TRUE.toward_foot[OWN]).sum(axis=1)
    assert np.median(cosine[thick]) > 0.98
    assert np.nanmedian(told.radius[fine] / TRUE.radius[OWN][fine]) == pytest.approx(1, abs=0.1)


def test_what_was_marked_is_no_wood_and_a_neighbour_is_not_told_of(example: FieldExample) -> None:
    height = XYZ[:, 2]
    between = (height > HIGH) & (height < HIGHEST)
    assert set(example.truth.role[height > HIGHEST].tolist()) == {int(Role.NO_WOOD)}
    assert set(example.truth.role[between].tolist()) == {UNTOLD}
    lower = example.truth.role[height < HIGH]
    assert Role.NO_WOOD not in lower, "the mark that was undone does not count"


def test_points_of_which_nobody_said_anything_are_untold(work: Path, tmp_path: Path) -> None:
    other = tmp_path / "work"
    copytree(work, other)
    trunk = TREE.truth.label == Label.TRUNK
    record = read_record(work / "tree" / "corrected.json")[1].input
    write_skeleton(other / "tree" / "corrected.json", TREE.truth.part(trunk), input=record)
    told = example_in(other, work.parent / "scans").truth.role
    fruiting = (TRUE.role[OWN] == Role.FRUITING_UNIT) & (XYZ[:, 2] < HIGH)
    assert (told[fruiting] == UNTOLD).mean() > 0.9
    assert (told[TRUE.role[OWN] == Role.STEM] == Role.STEM).mean() > 0.95


@pytest.mark.parametrize("lost", ["graph.npz", "mask.ply", "journal.jsonl"])
def test_what_the_studio_left_may_be_partly_lost(
    work: Path, tmp_path: Path, example: FieldExample, lost: str
) -> None:
    other = tmp_path / "work"
    copytree(work, other)
    (other / "tree" / lost).unlink()
    found = example_in(other, work.parent / "scans").truth.role
    marked = (XYZ[:, 2] > HIGHEST) | (example.truth.role < 0)
    assert (found == example.truth.role)[~marked].mean() > 0.98
    assert (found[XYZ[:, 2] > HIGHEST] == Role.NO_WOOD).all() == (lost != "journal.jsonl")


def test_an_example_is_read_as_it_was_written(example: FieldExample, tmp_path: Path) -> None:
    example.write(tmp_path / "one.npz")
    again = FieldExample.read(tmp_path / "one.npz")
    assert np.array_equal(again.truth.role, example.truth.role)
    unknown = np.isnan(example.truth.radius)
    assert unknown.any() and np.array_equal(np.isnan(again.truth.radius), unknown)


def test_neither_the_untold_nor_an_unknown_radius_counts_in_the_loss(example: FieldExample) -> None:
    torch = pytest.importorskip("torch", reason="training needs torch")
    from prunus.field.network import COLUMNS
    from prunus.lab.learn.field.lessons import Batch, losses_of

    batch = Batch.of(lesson_of(example))
    assert (batch.role == UNTOLD).any()
    outputs = torch.rand(len(batch.role), sum(COLUMNS.values()), generator=torch.manual_seed(0))
    losses = losses_of(outputs, batch)
    outputs[batch.role == UNTOLD] = 50.0
    assert all(bool(value.isfinite()) for value in losses.values())
    assert losses == losses_of(outputs, batch)
