"""A path in the making: the way that is shown is the one that is added."""

import numpy as np
import pytest

from prunus.editing import AddPath, Draft, State
from prunus.editing.steps import stepped
from prunus.model import Label
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.studio.modes.path import Path, Scope
from prunus.studio.picture import Slab
from prunus.studio.tree import picture_of
from tests.conftest import simulated


@pytest.fixture(scope="module")
def scope() -> Scope:
    truth, cloud = simulated(4)
    state = State.of(skeletonize(cloud, truth.xyz[0], Parameters.paper()))
    return Scope(picture_of(state, state.result.in_house), state, Slab())


def path_of(*stops: int) -> Path:
    path = Path()
    path.stops = list(stops)
    return path


def far_pair(draft: Draft, edges: np.ndarray) -> tuple[int, int]:
    """A node of the tree and a superpoint outside it, two candidate edges away and no nearer."""
    beside: dict[int, set[int]] = {}
    for i, j in edges.tolist():
        beside.setdefault(i, set()).add(j)
        beside.setdefault(j, set()).add(i)
    for start in draft.nodes:
        free = {node for node in beside.get(start, set()) if node not in draft}
        far = {end for node in free for end in beside[node]} - {start} - beside[start]
        further = [end for end in sorted(far) if end not in draft]
        if further:
            return start, further[0]
    pytest.fail("no superpoint is two edges away from the tree")


def test_the_routed_way_is_the_one_that_is_added(scope: Scope) -> None:
    draft, graph = scope.state.draft, scope.state.result.graph
    start, end = far_pair(draft, graph.edges)
    way = path_of(start, end).way(scope, routed=True)
    after = stepped(draft, AddPath((start, end), Label.SIDE_BRANCH, routed=True), graph).draft
    added = after.below(end)[::-1]
    added = added[added.index(start) :]
    assert len(way) == len(added) > 2
    assert np.array_equal(way, after.places[added])


def test_a_straight_way_goes_from_stop_to_stop(scope: Scope) -> None:
    start, end = far_pair(scope.state.draft, scope.state.result.graph.edges)
    path = path_of(start, end)
    assert np.array_equal(path.way(scope, routed=False), path.places(scope))


def test_where_no_way_leads_the_straight_one_is_shown(scope: Scope) -> None:
    nodes = scope.state.draft.nodes
    path = path_of(nodes[0], nodes[1])
    assert len(path.way(scope, routed=True)) == 2
    assert path_of().way(scope, routed=True).shape == (0, 3)
    assert path_of(nodes[0]).way(scope, routed=True).shape == (1, 3)
