import numpy as np
import pytest

from prunus.lab.simulate.orchard import write_simulated
from prunus.lab.simulate.scan_folder import read_scan
from prunus.lab.simulate.wide.general import grow_general
from prunus.lab.simulate.wide.plant import plant_wide
from prunus.lab.simulate.wide.points import UNKNOWN_ROLE, point_truth, roles_of, written_truth
from prunus.lab.simulate.wide.scan import simulate_wide
from prunus.lab.simulate.wide.scanners import scan_with
from prunus.lab.simulate.wide.settings import wide_orchard
from prunus.lab.simulate.wide.surface import sample_pieces
from prunus.lab.simulate.wide.ufo import grow_wide_ufo, wide_habits
from prunus.model import Kind, Label, Role

SEED_NOT_OF_THE_RIG = 7


@pytest.fixture(scope="module")
def scan():
    return simulate_wide(SEED_NOT_OF_THE_RIG)


def test_the_same_seed_gives_the_same_scan(scan):
    again = simulate_wide(SEED_NOT_OF_THE_RIG)
    assert np.array_equal(again.xyz, scan.xyz) and np.array_equal(again.kind, scan.kind)


def test_wood_lies_around_its_axis_and_the_rest_has_none(scan):
    truth = point_truth(scan)
    wood = scan.tree >= 0
    assert (truth.role[~wood] == Role.NO_WOOD).all() and (truth.branch[~wood] == -1).all()
    off = np.linalg.norm(truth.axis - scan.xyz, axis=1)
    assert np.median(np.abs(off - truth.radius)[wood]) < 0.015
    assert (off[~wood] == 0).all()
    assert np.linalg.norm(truth.toward_foot[wood], axis=1) == pytest.approx(1)


def test_a_written_scan_tells_the_truth_of_its_points(scan, tmp_path):
    write_simulated(tmp_path, scan)
    read, ours = written_truth(read_scan(tmp_path)), point_truth(scan)
    wood = scan.tree >= 0
    assert np.array_equal(read.role, ours.role) and np.array_equal(read.branch, ours.branch)
    assert (read.role[~wood] == Role.NO_WOOD).all()
    apart = np.linalg.norm(read.axis - ours.axis, axis=1)[wood]
    assert np.median(apart) < 1e-3 and np.quantile(apart, 0.95) < 0.04
    assert np.quantile(np.abs(read.radius - ours.radius)[wood], 0.95) < 0.002
    assert np.median((read.toward_foot * ours.toward_foot).sum(axis=1)[wood]) > 0.99
    # The nearest edge of the right branch is nearer than the edge that noise left behind.
    off = [np.linalg.norm(t.axis - scan.xyz, axis=1)[wood] for t in (read, ours)]
    assert off[0].mean() <= off[1].mean() + 1e-3


@pytest.mark.parametrize("seed", range(6))
def test_ufo_trees_of_every_kind_stand_and_have_each_role_in_its_place(seed):
    rng = np.random.default_rng(seed)
    tree = grow_wide_ufo(rng, wide_orchard().ufo)
    role, branch = roles_of(tree)
    assert tree.xyz[:, 2].max() > 0.5 and np.isfinite(tree.radius).all()
    assert (role[tree.label == Label.LEADER] == Role.FRUITING_UNIT).all()
    assert UNKNOWN_ROLE not in role
    assert branch[1:].min() >= 0


@pytest.mark.parametrize("seed", range(6))
def test_of_trees_of_any_form_only_stem_and_spurs_have_a_role(seed):
    tree = grow_general(np.random.default_rng(seed), wide_orchard().general)
    role, _ = roles_of(tree)
    assert set(np.unique(role)) <= {UNKNOWN_ROLE, Role.STEM, Role.SPUR_OR_SHOOT}
    assert (role[tree.label == Label.TRUNK] == Role.STEM).all()
    assert (tree.radius[1:] > 0).all()


def test_a_textbook_tree_is_straight():
    ranges = wide_orchard().ufo.model_copy(update={"textbook": 1.0})
    habits = wide_habits(np.random.default_rng(0), ranges)
    assert habits.leader.tilt == (0, 0) and habits.leader.crosses == 0
    assert habits.support.climb == (0, 0) and habits.trunk.lean == (0, 0)


@pytest.mark.parametrize("name", [name for name in wide_orchard().scanner if name != "rig"])
@pytest.mark.slow
def test_each_scanner_sees_wood_where_it_is(name):
    rng = np.random.default_rng(3)
    orchard = wide_orchard()
    row = plant_wide(rng, orchard)
    surface = sample_pieces(rng, row.pieces, 0.01)
    seen = scan_with(rng, name, orchard.scanner[name], surface, row.pieces)
    assert len(seen.xyz) == len(seen.piece) == len(seen.station)
    assert len(seen.xyz) > 500
    kind = row.pieces.kind[seen.piece]
    assert (kind == Kind.TARGET).any()
