"""Refined skeletons: drawn rods with known axes, then the laws on simulated trees."""

import numpy as np
import pytest

from prunus.geometry.near import nearest
from prunus.lab.simulate import simulate_scan
from prunus.model import Floats, Label, PointCloud, RigidMotion, Skeleton
from prunus.model.branches import branches
from prunus.refine.radii import Unknown
from prunus.refine.refined import Refined, refined
from prunus.rules import offenders


def half_rod(
    rng: np.random.Generator, foot: Floats, tip: Floats, radius: float, count: int = 3000
) -> Floats:
    """Points (count, 3) on the side of a round rod that faces a camera before the tree."""
    at = foot + rng.random(count)[:, None] * (tip - foot)
    along = (tip - foot) / np.linalg.norm(tip - foot)
    ray = (at - [0.0, -1.5, 1.45]) * [0.5, 1.0, 1.0]
    back = ray - (ray @ along)[:, None] * along
    back /= np.linalg.norm(back, axis=1, keepdims=True)
    side = np.cross(along, back)
    across = rng.uniform(-1, 1, count)[:, None] * radius
    depth = -np.sqrt(radius**2 - across**2)
    return np.asarray(at + across * side + depth * back)


def ring(rng: np.random.Generator, foot: Floats, tip: Floats, radius: float) -> Floats:
    """Points (6000, 3) on all sides of an upright round rod."""
    turn = rng.uniform(0, 2 * np.pi, 6000)
    around = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(6000)])
    return np.asarray(foot + rng.random(6000)[:, None] * (tip - foot) + radius * around)


FOOT, TOP = np.array([0.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
FORK, END = np.array([0.0, 0.0, 0.6]), np.array([0.3, 0.0, 0.75])


@pytest.fixture
def forked(rng: np.random.Generator) -> tuple[Skeleton, PointCloud]:
    """A trunk of radius 30 mm, a support of 12 mm from it, and a rough skeleton in front of both.

    The trunk's last 15 cm and the support's last 7 cm have no node; the support starts too high.
    """
    cloud = PointCloud.from_xyz(
        np.concatenate([half_rod(rng, FOOT, TOP, 0.03), half_rod(rng, FORK, END, 0.012)])
    )
    nodes = np.array(
        [[0.01, -0.03, 0.02], [-0.01, -0.03, 0.3], [0.0, -0.02, 0.64], [0.01, -0.03, 0.85],
         [0.11, -0.01, 0.65], [0.24, -0.02, 0.71]]
    )  # fmt: skip
    labels = [Label.TRUNK] * 4 + [Label.SUPPORT] * 2
    rough = Skeleton.build(nodes, [-1, 0, 1, 2, 2, 4], labels, superpoint=np.arange(6))
    return rough.moved(cloud.to_input.inverse()), cloud


def in_place(tree: Refined, cloud: PointCloud) -> Skeleton:
    return tree.skeleton.moved(cloud.to_input)


def test_lines_lie_on_the_axes(forked: tuple[Skeleton, PointCloud]) -> None:
    skeleton = in_place(refined(*forked), forked[1])
    trunk = skeleton.xyz[skeleton.label == Label.TRUNK]
    assert np.median(np.hypot(trunk[:, 0], trunk[:, 1])) < 0.007, "a quarter of the radius"
    support = skeleton.xyz[skeleton.label == Label.SUPPORT]
    along = (END - FORK) / np.linalg.norm(END - FORK)
    off = support - FORK - np.outer((support - FORK) @ along, along)
    assert np.median(np.linalg.norm(off, axis=1)) < 0.004


@pytest.mark.parametrize("noise", [0.0, 0.003, 0.006])
def test_wood_seen_from_all_around_is_not_pushed_away_from_the_cameras(
    noise: float, rng: np.random.Generator
) -> None:
    points = np.concatenate([ring(rng, FOOT, TOP, 0.03), half_rod(rng, FORK, END, 0.012)])
    cloud = PointCloud.from_xyz(points + noise * rng.normal(size=points.shape))
    nodes = [
        [0.0, 0.01, 0.0],
        [0.01, -0.01, 0.6],
        [0.0, 0.02, 1.0],
        [0.2, 0.0, 0.7],
        [0.29, 0, 0.74],
    ]
    labels = [Label.TRUNK] * 3 + [Label.SUPPORT] * 2
    rough = Skeleton.build(nodes, [-1, 0, 1, 1, 3], labels).moved(cloud.to_input.inverse())
    skeleton = in_place(refined(rough, cloud), cloud)
    trunk, support = branches(skeleton)
    assert abs(np.median(skeleton.xyz[trunk.rows[1:], 1])) < 0.002
    assert np.median(skeleton.radius[trunk.rows[1:]]) == pytest.approx(0.03, abs=0.002)
    assert abs(np.median(skeleton.xyz[support.rows[1:], 1])) < 0.004, "still seen from one side"


def test_a_branch_starts_where_its_axis_meets_its_parents(
    forked: tuple[Skeleton, PointCloud],
) -> None:
    skeleton = in_place(refined(*forked), forked[1])
    _, support = branches(skeleton)
    assert np.linalg.norm(skeleton.xyz[support.rows[0]] - FORK) < 0.012


def test_tips_lie_where_the_wood_ends(forked: tuple[Skeleton, PointCloud]) -> None:
    skeleton = in_place(refined(*forked), forked[1])
    trunk, support = branches(skeleton)
    assert np.linalg.norm(skeleton.xyz[trunk.rows[-1]] - TOP) < 0.02
    assert np.linalg.norm(skeleton.xyz[support.rows[-1]] - END) < 0.02


def test_a_tip_beyond_the_wood_is_cut_off(rng: np.random.Generator) -> None:
    cloud = PointCloud.from_xyz(half_rod(rng, FOOT, 0.5 * TOP, 0.02))
    rough = Skeleton.build([FOOT, 0.4 * TOP, 0.7 * TOP], [-1, 0, 1], [0, 0, 0])
    found = refined(rough.moved(cloud.to_input.inverse()), cloud)
    assert in_place(found, cloud).xyz[:, 2].max() == pytest.approx(0.5, abs=0.02)


def test_radii_are_those_of_the_rods(forked: tuple[Skeleton, PointCloud]) -> None:
    found = refined(*forked)
    for label, radius in ((Label.TRUNK, 0.03), (Label.SUPPORT, 0.012)):
        rows = found.skeleton.edges_with(label)
        wrong = np.abs(found.skeleton.radius[rows] - radius)
        assert np.median(wrong) < 0.15 * radius, "one camera sees a tenth less than several"
        assert (wrong < 3 * found.radius_error[rows]).mean() > 0.9


def test_a_line_takes_no_points_of_its_neighbour(rng: np.random.Generator) -> None:
    aside = np.array([0.05, 0.0, 0.0])
    points = [half_rod(rng, FOOT + x, TOP + x, 0.012) for x in (0 * aside, aside)]
    cloud = PointCloud.from_xyz(np.concatenate(points))
    nodes = np.array([FOOT, 0.5 * TOP, TOP, 0.5 * TOP + aside, TOP + aside])
    rough = Skeleton.build(nodes, [-1, 0, 1, 0, 3], [0, 0, 0, 1, 1])
    skeleton = in_place(refined(rough.moved(cloud.to_input.inverse()), cloud), cloud)
    upper = skeleton.xyz[skeleton.xyz[:, 2] > 0.6]
    near = np.minimum(np.abs(upper[:, 0]), np.abs(upper[:, 0] - aside[0]))
    assert near.max() < 0.004


def test_without_points_nothing_moves_and_no_radius_is_told(
    forked: tuple[Skeleton, PointCloud],
) -> None:
    rough = forked[0]
    elsewhere = PointCloud.from_xyz(np.array([[5.0, 5.0, 5.0], [6.0, 6.0, 6.0]]))
    found = refined(rough, elsewhere)
    assert np.isnan(found.skeleton.radius).all() and not found.seen.any()
    assert set(found.reason) == {"few points"}
    assert (nearest(rough.xyz, found.skeleton.xyz, 0.05) >= 0).all()


def test_the_base_alone_stays_as_it_is() -> None:
    bare = Skeleton.build([[0, 0, 0]], [-1], [0], superpoint=[3])
    found = refined(bare, PointCloud.from_xyz(np.zeros((1, 3))))
    assert len(found.skeleton) == 1 and found.skeleton.superpoint.tolist() == [3]
    assert found.unknown.tolist() == [Unknown.FEW_POINTS]


def rough_tree(seed: int, setting: str = "clean") -> tuple[Skeleton, PointCloud, Skeleton]:
    """A true tree with every fifth node, 1 cm astray; the points; the true tree, house frame."""
    scan = simulate_scan(seed, setting)  # type: ignore[arg-type]
    cloud = scan.target_cloud()
    truth = scan.truth.moved(cloud.to_input.inverse())
    kept = np.zeros(len(truth), np.bool_)
    for branch in branches(truth):
        kept[branch.rows[::-5]] = True
        kept[branch.rows[[0, -1]]] = True
    above = truth.parent.copy()
    for row in range(1, len(truth)):
        if above[row] > 0 and not kept[above[row]]:
            above[row] = above[above[row]]
    rows = np.flatnonzero(kept)
    astray = np.random.default_rng(seed).normal(0, 0.006, (len(rows), 3)) - [0, 0.01, 0]
    parent = np.searchsorted(rows, above[rows])
    parent[0] = -1
    rough = Skeleton.build(
        truth.xyz[rows] + astray, parent, truth.label[rows], superpoint=np.arange(len(rows))
    )
    return rough, cloud, truth


@pytest.mark.parametrize("seed", [0, 1])
def test_a_tree_keeps_its_labels_topology_and_superpoints(seed: int) -> None:
    rough, cloud, _ = rough_tree(seed)
    skeleton = refined(rough, cloud).skeleton
    assert list(offenders(skeleton)) == list(offenders(rough))
    stands = {int(node): row for row, node in enumerate(skeleton.superpoint) if node >= 0}
    assert sorted(stands) == list(range(len(rough)))
    for node in range(1, len(rough)):
        assert skeleton.label[stands[node]] == rough.label[node]
    ours, theirs = branches(skeleton), branches(rough)
    assert sorted(b.label for b in ours) == sorted(b.label for b in theirs)
    tips = {int(skeleton.superpoint[b.rows].max()) for b in ours}
    assert tips == {int(b.rows.max()) for b in theirs}


@pytest.mark.parametrize("seed", [0, 1])
def test_a_tree_comes_much_nearer_to_the_truth(seed: int) -> None:
    rough, cloud, truth = rough_tree(seed)
    found = refined(rough, cloud)
    fine = np.concatenate([truth.xyz - s * truth.edge_vectors for s in np.linspace(0, 1, 20)])
    off = np.array(
        [
            np.linalg.norm(fine - place, axis=1).min()
            for place in found.skeleton.xyz[found.seen][::7]
        ]
    )
    assert np.median(off) < 0.005
    assert np.percentile(off, 90) < 0.015


@pytest.mark.parametrize("seed", [0, 1])
def test_branches_taper_outward(seed: int) -> None:
    rough, cloud, _ = rough_tree(seed, "hard")
    found = refined(rough, cloud)
    for branch in branches(found.skeleton):
        radius = found.skeleton.radius[branch.rows[1:]]
        known = radius[np.isfinite(radius)]
        assert (np.diff(known) < 1e-9).all()
    known_at = np.isfinite(found.skeleton.radius)
    assert (known_at == (found.unknown == Unknown.KNOWN)).all()
    assert (np.isfinite(found.radius_error) == known_at).all()


def test_a_moved_tree_is_refined_alike(forked: tuple[Skeleton, PointCloud]) -> None:
    rough, cloud = forked
    away = RigidMotion(np.eye(3), np.array([0.5, -0.25, 2.0]))
    moved = PointCloud(away.apply(cloud.xyz), cloud.to_input)
    first, second = refined(rough, cloud), refined(rough.moved(away), moved)
    assert second.skeleton.xyz == pytest.approx(away.apply(first.skeleton.xyz), abs=1e-6)
    assert second.skeleton.radius == pytest.approx(first.skeleton.radius, abs=1e-6)


def test_the_same_input_gives_the_same_bits(forked: tuple[Skeleton, PointCloud]) -> None:
    first, second = refined(*forked), refined(*forked)
    assert np.array_equal(first.skeleton.xyz, second.skeleton.xyz)
    assert np.array_equal(first.skeleton.radius, second.skeleton.radius, equal_nan=True)
