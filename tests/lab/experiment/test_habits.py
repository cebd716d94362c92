"""Habits read off small trees."""

from prunus.lab.experiment.habits import habits_of
from tests.drawn import TREE, tree


def test_a_textbook_tree_has_no_habits() -> None:
    assert habits_of(tree(TREE)) == ()


def test_one_arm_and_a_leader_that_goes_level() -> None:
    level = """
        l
        l
        l
    sllll
    s
    t
    o
    """
    assert set(habits_of(tree(level))) == {"one arm", "climbing support", "sideways leader"}


def test_leaders_that_keep_beside_each_other() -> None:
    beside = """
    l l
    l l
    l l
    l l
    l l
    l l
    sss
      t
      o
    """
    assert "leaders close or crossing" not in habits_of(tree(beside))
    nearer = tree(beside)
    moved = nearer.xyz * [0.4, 1, 1]
    assert "leaders close or crossing" in habits_of(
        type(nearer).build(moved, nearer.parent, nearer.label)
    )
