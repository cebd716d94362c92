"""A path in the making: its stops, click by click."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from prunus.editing import AddPath, State
from prunus.editing.state import clear
from prunus.editing.wire import Place
from prunus.errors import PrunusError
from prunus.model import Floats, Label
from prunus.studio.picking import Ray, first_point, nearest_point
from prunus.studio.picture import Picture, Slab

NODE_REACH = 14.0
"""A node or superpoint is meant so many pixels beside it."""
POINT_REACH = 6.0
"""A point of the scan is meant so many pixels beside it."""

FOLLOWING = {
    Label.TRUNK: Label.SUPPORT,
    Label.SUPPORT: Label.LEADER,
    Label.LEADER: Label.SIDE_BRANCH,
    Label.SIDE_BRANCH: Label.SIDE_BRANCH,
}
"""What leaves wood of a label, as a rule."""


@dataclass(frozen=True, eq=False)
class Scope:
    """What can be clicked: a picture, the nodes of its work with their places, and the slab."""

    picture: Picture
    state: State
    slab: Slab

    def tree_node(self, ray: Ray) -> int | None:
        """The node of the tree at a ray."""
        nodes = np.array(self.picture.nodes)
        held = nodes[self.slab.holds(self.state.draft.places[nodes])]
        best = nearest_point(ray, self.state.draft.places[held], NODE_REACH)
        return None if best is None else int(held[best])

    def superpoint(self, ray: Ray) -> int | None:
        """The superpoint at a ray that is not in the tree."""
        places = self.state.result.graph.xyz
        free = np.setdiff1d(np.arange(len(places)), self.picture.nodes)
        free = free[self.slab.holds(places[free])]
        best = nearest_point(ray, places[free], NODE_REACH)
        return None if best is None else int(free[best])

    def free_point(self, ray: Ray, beside: Floats) -> tuple[float, float, float]:
        """The point of the scan at a ray, else the ray where it is as far as `beside` (3,)."""
        scan = self.picture.scan
        xyz = scan.xyz[self.slab.holds(scan.xyz)]
        best = first_point(ray, xyz, POINT_REACH)
        depth = float((beside - ray.origin) @ ray.direction)
        place = ray.origin + depth * ray.direction if best is None else xyz[best]
        x, y, z = scan.to_input.apply(place).tolist()
        return x, y, z

    def at(self, place: Place) -> Floats:
        """A place (3,) in the house frame."""
        if isinstance(place, int):
            return np.asarray(self.state.draft.places[place])
        return self.picture.scan.to_input.inverse().apply(np.array(place))

    def suggested(self, node: int) -> Label:
        """The label that a path from a node most likely has."""
        row = self.picture.row(node)
        skeleton = self.picture.skeleton
        if not row or skeleton is None:
            return Label.TRUNK
        label = Label(skeleton.label[row])
        ends = not (skeleton.parent == row).any()
        return label if ends else FOLLOWING[label]


class Path:
    """The stops so far, the first a node of the tree."""

    def __init__(self) -> None:
        self.stops: list[Place] = []

    def add(self, scope: Scope, ray: Ray, snaps: bool) -> None:
        """One stop more; PrunusError where a path cannot begin. `snaps`: superpoints first."""
        if not self.stops:
            node = scope.tree_node(ray)
            if node is None:
                raise PrunusError("a path begins at a node of the tree; click nearer to one")
            self.stops.append(node)
            return
        node = scope.superpoint(ray) if snaps else None
        place = scope.free_point(ray, scope.at(self.stops[-1])) if node is None else node
        if place not in self.stops:
            self.stops.append(place)

    def places(self, scope: Scope) -> Floats:
        """The stops (Q, 3) in the house frame."""
        return _places(scope, self.stops)

    def way(self, scope: Scope, routed: bool) -> Floats:
        """The way (R, 3) over the stops as it would be added; straight where there is no other."""
        stops = tuple(self.stops)
        if routed and len(stops) > 1:
            with contextlib.suppress(PrunusError):
                act = clear(scope.state, AddPath(stops, Label.SIDE_BRANCH, routed=True))
                assert isinstance(act, AddPath)
                stops = act.stops
        return _places(scope, stops)


def _places(scope: Scope, stops: Iterable[Place]) -> Floats:
    return np.array([scope.at(stop) for stop in stops]).reshape(-1, 3)
