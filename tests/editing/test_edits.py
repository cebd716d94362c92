"""Two skeletons on the same nodes, when people added points of their own."""

from dataclasses import replace

import numpy as np

from prunus.editing.edits import edits, on_same_nodes
from prunus.model import Skeleton
from tests.drawn import tree


def with_free(last: int, moved: float = 0.0) -> Skeleton:
    """The drawn tree, its last nodes free points, moved a little."""
    whole = tree()
    number = np.arange(len(whole))
    free = number >= len(whole) - last
    xyz = whole.xyz + moved * free[:, None]
    return replace(whole, xyz=xyz, superpoint=np.where(free, -1, number))


def test_free_points_in_one_place_are_one_node_and_others_are_not() -> None:
    both = on_same_nodes(with_free(2), with_free(2))
    assert both is not None
    assert edits(*both).ratio == 0
    both = on_same_nodes(with_free(2), with_free(2, 0.01))
    assert both is not None
    assert (edits(*both).wrong, edits(*both).missing) == (2, 2)


def test_free_points_never_take_the_number_of_a_superpoint() -> None:
    both = on_same_nodes(with_free(0), with_free(3))
    assert both is not None
    assert (edits(*both).wrong, edits(*both).missing) == (3, 3)


def test_a_base_may_stand_lower_than_its_superpoint() -> None:
    whole = with_free(0)
    lower = replace(whole, xyz=np.concatenate([whole.xyz[:1] - [[0, 0, 0.1]], whole.xyz[1:]]))
    both = on_same_nodes(whole, lower)
    assert both is not None
    assert edits(*both).ratio == 0


def test_trees_on_other_superpoints_have_no_nodes_in_common() -> None:
    one = with_free(0)
    assert on_same_nodes(one, replace(one, xyz=one.xyz + 0.01)) is None
    assert on_same_nodes(one, with_free(len(one))) is None
