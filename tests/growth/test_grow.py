"""Threads of drawn trees grow to the trees that were drawn."""

from dataclasses import replace

import numpy as np
import pytest

from prunus.growth.feet import find_feet
from prunus.growth.graph import join_threads
from prunus.model import Floats, Label, RigidMotion, Role, Skeleton
from prunus.model.branches import branches
from prunus.model.rotations import turned
from prunus.rules import offenders
from tests.growth.drawn import TEXTBOOK, Piece, grow, threads_of

BARE = TEXTBOOK[:-2]
LEVEL = [(0.1, 0, 0.64), (0.2, 0, 0.70), (0.85, 0, 0.72), (0.9, 0, 1.6)]


def count(tree: Skeleton) -> list[int]:
    return [len(branches(tree, label)) for label in Label]


def foot_of_branch_at(tree: Skeleton, place: Floats) -> Floats:
    """Where the branch leaves its parent that comes by a place."""
    row = int(np.linalg.norm(tree.xyz - place, axis=1).argmin())
    one = next(branch for branch in branches(tree) if row in branch.rows[1:])
    return np.asarray(tree.xyz[one.rows[0]])


@pytest.mark.parametrize("seed", [None, 1, 2, 3])
def test_a_textbook_tree_grows_as_it_was_drawn(seed: int | None) -> None:
    tree = grow(threads_of(TEXTBOOK, seed))
    assert count(tree) == [1, 2, 4, 2]
    assert offenders(tree) == {}
    assert np.linalg.norm(tree.xyz[0]) < 0.01
    assert tree.lengths.sum() == pytest.approx(0.6 + 2 * 0.95 + 4 * 1.25 + 2 * 0.22, rel=0.03)


@pytest.mark.parametrize("gap", [0.05, 0.1, 0.2])
def test_a_gap_is_bridged_along_the_branch_and_not_to_its_nearer_neighbour(gap: float) -> None:
    above = (Role.FRUITING_UNIT, [(0.4, 0, 1.0 + gap), (0.4, 0, 1.9)], 0.012)
    below = (Role.FRUITING_UNIT, [(0.4, 0, 0.67), (0.4, 0, 1.0)], 0.012)
    beside = (Role.FRUITING_UNIT, [(0.49, 0, 0.67), (0.49, 0, 1.9)], 0.012)
    tree = grow(threads_of([*TEXTBOOK[:3], below, above, beside]))
    assert count(tree)[Label.LEADER] == 2
    assert foot_of_branch_at(tree, np.array([0.4, 0, 1.9]))[0] == pytest.approx(0.4, abs=0.03)


def test_leaders_that_cross_keep_their_tops() -> None:
    crossing: list[Piece] = [
        (Role.FRUITING_UNIT, [(0.3, 0.00, 0.66), (0.7, 0.00, 1.9)], 0.012),
        (Role.FRUITING_UNIT, [(0.7, 0.02, 0.66), (0.3, 0.02, 1.9)], 0.012),
    ]
    tree = grow(threads_of([*TEXTBOOK[:3], *crossing]))
    assert count(tree)[Label.LEADER] == 2
    for top, foot in ((0.7, 0.3), (0.3, 0.7)):
        place = foot_of_branch_at(tree, np.array([top, 0.01, 1.9]))
        assert place[0] == pytest.approx(foot, abs=0.04)


def test_a_leader_does_not_hang_on_another_that_it_touches_where_its_support_is_near() -> None:
    level = (Role.FRUITING_UNIT, LEVEL, 0.012)
    upright = (Role.FRUITING_UNIT, [(0.5, 0.02, 0.73), (0.5, 0.02, 1.8)], 0.012)
    tree = grow(threads_of([*TEXTBOOK[:3], level, upright]))
    assert count(tree)[Label.LEADER] == 2
    assert foot_of_branch_at(tree, np.array([0.5, 0.02, 1.8]))[2] < 0.66


def beside(pieces: list[Piece], shift: float) -> list[Piece]:
    return [(role, [(x + shift, y, z) for x, y, z in way], r) for role, way, r in pieces]


@pytest.mark.parametrize("apart", [1.86, 2.2, 3.0])
def test_each_tree_of_a_row_grows_from_its_own_foot(apart: float) -> None:
    threads = threads_of([*TEXTBOOK, *beside(BARE, apart)])
    feet = find_feet(join_threads(threads))
    assert sorted(threads.xyz[feet, 0].round(2).tolist()) == [0, apart]
    tree = grow(threads, np.zeros(3))
    assert count(tree) == [1, 2, 4, 2]
    assert np.abs(tree.xyz[:, 0]).max() < 0.93


def test_what_looks_like_stem_in_the_crown_is_no_foot() -> None:
    false: Piece = (Role.STEM, [(0.4, 0, 1.3), (0.4, 0, 1.6)], 0.012)
    threads = threads_of([*TEXTBOOK, false])
    feet = find_feet(join_threads(threads))
    assert len(feet) == 1
    assert threads.xyz[feet[0], 2] < 0.02


def test_where_no_stem_is_in_view_the_tree_stands_on_its_lowest_end() -> None:
    tree = grow(threads_of([*TEXTBOOK[1:]]))
    assert tree.xyz[0, 2] == pytest.approx(0.61, abs=0.01)
    assert count(tree)[Label.LEADER] == 4


def test_sure_wood_without_a_legal_place_stays_under_the_best_legal_label() -> None:
    on_trunk: Piece = (Role.FRUITING_UNIT, [(0.02, 0, 0.2), (0.3, 0.3, 0.9)], 0.012)
    tree = grow(threads_of([*TEXTBOOK, on_trunk]))
    assert np.linalg.norm(tree.xyz - np.array([0.3, 0.3, 0.9]), axis=1).min() < 0.03


@pytest.mark.parametrize("angle", [90, 180, 37])
def test_a_turned_tree_grows_turned(angle: float) -> None:
    threads = threads_of(TEXTBOOK, 1)
    turn = turned(np.array([0, 0, np.radians(angle)]))
    toward_foot = threads.toward_foot @ turn.T
    moved = replace(threads, xyz=threads.xyz @ turn.T, toward_foot=toward_foot)
    here = grow(threads).moved(RigidMotion(turn, np.zeros(3)))
    there = grow(moved)
    assert np.allclose(here.xyz, there.xyz, atol=1e-6)
    assert (here.label == there.label).all()


def test_a_scrap_in_the_middle_is_not_meant_where_a_tree_stands_aside() -> None:
    scrap: Piece = (Role.STEM, [(1.6, -0.4, 0.1), (1.6, -0.4, 0.35)], 0.012)
    arm: Piece = (Role.FRAMEWORK, [(0.9, 0, 0.65), (3.2, 0, 0.7)], 0.02)
    tree = grow(threads_of([*TEXTBOOK, arm, scrap]))
    assert abs(tree.xyz[0, 0]) < 0.02
