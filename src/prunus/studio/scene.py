"""What is drawn in the scene of one browser: points, skeleton, evidence, and what was picked."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from prunus.io.skeletons.export import COLOURS
from prunus.model import Floats, Ints, Kind, Label
from prunus.model.arrays import Bytes
from prunus.report.cuts import joined
from prunus.report.scene import CLASSES
from prunus.studio.picture import Colour, Picture, Slab, colour_of, colours_of, thinned

PICKED: Colour = (230, 30, 160)
BESIDE: Colour = (250, 170, 215)
MACHINE: Colour = (150, 120, 60)
POINTS = "/points/scan"
NEARER = {"/points": 0.0, "/halo": 0.035, "/front": 0.04, "/mark": 0.05}
"""By this share of its distance each sheet of the scene is drawn nearer to the eye."""
WIDTHS = {Label.TRUNK: 7.0, Label.SUPPORT: 6.0, Label.LEADER: 5.0, Label.SIDE_BRANCH: 4.0}
"""Pixels."""
EVIDENCE = {
    f"candidates {low:.1f} to {min(high, 1):.1f}": (low, high, colour)
    for low, high, colour in CLASSES
}
"""The confidence classes of candidate edges by name: from, up to, colour."""
LAYERS = ("points", *(label.word for label in Label), "tips", "base", "superpoints", *EVIDENCE,
          "machine's skeleton")  # fmt: skip
"""All that can be switched on and off."""
AT_FIRST = frozenset(LAYERS[:7]) - {"tips"} | {"base"}


@dataclass(frozen=True, kw_only=True)
class Wishes:
    """What the person wants to see: layers by name, colour and number and size of the points."""

    layers: frozenset[str] = AT_FIRST
    colour: str = "grey"
    share: float = 1.0
    size: float = 0.003
    others: bool = False
    slab: Slab = field(default_factory=Slab)


def nearer(name: str) -> float:
    """How much nearer to the eye a node is drawn, by the sheet that its name begins with."""
    return NEARER[f"/{name.split('/')[1]}"]


@dataclass(kw_only=True)
class Drawn:
    """A node of the scene as the browser has it."""

    places: bytes
    form: tuple[object, ...]
    colours: bytes
    handle: Any


class Painter:
    """Draws pictures into one scene; what is as it was is not sent again."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self.scene = scene
        self.drawn: dict[str, Drawn] = {}
        self.sheets = {name: scene.add_frame(name, show_axes=False) for name in NEARER}

    def stand_at(self, eye: Floats) -> None:
        """Draw for an eye (3,): all but the scan a little nearer to it, looking the same.

        What is scaled about the eye is seen where it was, but the points of the wood around a
        branch no longer hide it.
        """
        for name, sheet in self.sheets.items():
            sheet.position = NEARER[name] * eye

    def paint(self, picture: Picture, wishes: Wishes) -> None:
        """All layers."""
        self.points(picture, wishes)
        self.skeleton(picture, wishes)
        self.evidence(picture, wishes)

    def points(self, picture: Picture, wishes: Wishes) -> None:
        """The thinned cloud; what is not the tree only where it is wanted."""
        rows = thinned(len(picture.scan))
        rows = rows[: max(int(wishes.share * len(rows)), 1)]
        if picture.kind is not None and not wishes.others:
            rows = rows[picture.kind[rows] == Kind.TARGET]
        rows = rows[wishes.slab.holds(picture.scan.xyz[rows])]
        colours = colours_of(picture, rows, wishes.colour)
        shown = "points" in wishes.layers
        self.dots(POINTS, picture.scan.xyz[rows], colours, wishes.size, shown)

    def skeleton(self, picture: Picture, wishes: Wishes) -> None:
        """The skeleton by label, its base, and that of the machine behind it."""
        skeleton = picture.skeleton
        if skeleton is None:
            return
        for label in Label:
            rows = np.flatnonzero(skeleton.edges_with(label))
            ends = skeleton.xyz[np.column_stack([skeleton.parent[rows], rows])]
            shown = label.word in wishes.layers
            name = f"/front/{label.word}"
            self.lines(name, ends, COLOURS[label], WIDTHS[label], wishes, shown)
        self.dots("/front/base", skeleton.xyz[:1], (204, 0, 0), 0.016, "base" in wishes.layers)
        if picture.machine is not None:
            ends = picture.machine.xyz[picture.machine.edges]
            shown = "machine's skeleton" in wishes.layers
            self.lines("/front/machine", ends, MACHINE, 2.5, wishes, shown)

    def evidence(self, picture: Picture, wishes: Wishes) -> None:
        """Candidate edges by confidence, superpoints and tips."""
        graph = picture.graph
        if graph is None:
            return
        for name, (low, high, colour) in EVIDENCE.items():
            chosen = graph.edges[(graph.confidence >= low) & (graph.confidence < high)]
            shown = name in wishes.layers
            self.lines(f"/front/{name}", graph.xyz[chosen], colour_of(colour), 2.0, wishes, shown)
        inside = wishes.slab.holds(graph.xyz)
        shown = "superpoints" in wishes.layers
        self.dots("/front/superpoints", graph.xyz[inside], (90, 90, 90), 0.006, shown)
        tips = graph.xyz[graph.tips]
        self.dots("/front/tips", tips, (204, 121, 167), 0.014, "tips" in wishes.layers)

    def mark(self, name: str, ends: Floats, colour: Colour, width: float) -> None:
        """Lines (E, 2, 3) over all else, such as what was picked; none takes them away."""
        self.lines(f"/mark/{name}", ends, colour, width, Wishes(), True)

    def halo(self, ends: Floats, colour: Colour, width: float) -> None:
        """Lines (E, 2, 3) behind the skeleton, around what was picked; none takes them away."""
        self.lines("/halo/picked", ends, colour, width, Wishes(), True)

    def places(self, name: str, xyz: Floats, colour: Colour, size: float = 0.012) -> None:
        """Places (Q, 3) such as the stops of a path; none takes them away."""
        self.dots(f"/mark/{name}", xyz, colour, size, True)

    def lines(
        self, name: str, ends: Floats, colour: Colour, width: float, wishes: Wishes, shown: bool
    ) -> None:
        """Edges (E, 2, 3) of one colour, so many pixels wide, those in the slab."""
        held = ends[wishes.slab.holds_edges(ends)].astype(np.float32)
        if not shown or len(held) == 0:
            self._remove(name)
        elif not self._stands(name, held, (colour, width)):
            handle = self.scene.add_line_segments(
                name, held, colour, thickness=width, thickness_units="screen",
                scale=1 - nearer(name),
            )  # fmt: skip
            self.drawn[name] = Drawn(
                places=held.tobytes(), form=(colour, width), colours=b"", handle=handle
            )

    def dots(
        self, name: str, xyz: Floats, colours: Bytes | Colour, size: float, shown: bool
    ) -> None:
        """Points (Q, 3) of one colour or of colours (Q, 3), of so many metres."""
        held, colour = xyz.astype(np.float32), np.asarray(colours, np.uint8)
        if not shown or len(held) == 0:
            self._remove(name)
        elif self._stands(name, held, (colour.shape, size)):
            self._recolour(self.drawn[name], colour)
        else:
            handle = self.scene.add_point_cloud(
                name, held, colour, point_size=size, point_shape="circle", point_shading="flat",
                precision="float32", scale=1 - nearer(name),
            )  # fmt: skip
            self.drawn[name] = Drawn(
                places=held.tobytes(),
                form=(colour.shape, size),
                colours=colour.tobytes(),
                handle=handle,
            )

    def mesh(
        self, name: str, parts: list[tuple[Floats, Ints]], colour: Colour, opacity: float
    ) -> None:
        """Surfaces of one colour, each vertices (V, 3) and triangles; none takes them away.

        Plainly lit: the usual material takes a browser without a GPU ten seconds to begin with.
        """
        if not parts:
            self._remove(name)
            return
        xyz, faces = joined(parts)
        held = xyz.astype(np.float32)
        if not self._stands(name, held, (colour, opacity)):
            handle = self.scene.add_mesh_simple(
                name, held, faces.astype(np.uint32), color=colour, opacity=opacity, side="double",
                material="toon3", cast_shadow=False, receive_shadow=False, scale=1 - nearer(name),
            )  # fmt: skip
            self.drawn[name] = Drawn(
                places=held.tobytes(), form=(colour, opacity), colours=b"", handle=handle
            )

    def clear(self) -> None:
        """Take all away."""
        for name in list(self.drawn):
            self._remove(name)

    def _stands(self, name: str, xyz: NDArray[np.float32], form: tuple[object, ...]) -> bool:
        """Whether a node is drawn at these places, in this form."""
        drawn = self.drawn.get(name)
        return drawn is not None and drawn.form == form and drawn.places == xyz.tobytes()

    def _recolour(self, drawn: Drawn, colour: Bytes) -> None:
        if drawn.colours != colour.tobytes():
            drawn.colours = colour.tobytes()
            drawn.handle.colors = colour

    def _remove(self, name: str) -> None:
        drawn = self.drawn.pop(name, None)
        if drawn is not None:
            drawn.handle.remove()


def without(wishes: Wishes, layer: str, shown: bool) -> Wishes:
    """The same wishes with a layer switched on or off."""
    layers = wishes.layers | {layer} if shown else wishes.layers - {layer}
    return replace(wishes, layers=layers)
