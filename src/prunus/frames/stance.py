"""How a scan stands: from the axes of its file to the house frame, by name and by evidence."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.frames.ground import find_ground
from prunus.frames.level import levelling
from prunus.frames.orient import Up, find_frame, local_wood
from prunus.frames.patches import Cells
from prunus.frames.rows import row_turn
from prunus.model import FRAMES, ROW_TOLD, Floats
from prunus.model.rotations import turned

VIEWER_M = 15.0
"""A scan whose origin is so near to its middle may have been taken from there."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Stance:
    """A named frame, the further rotation (3, 3) to the house frame, and notes on how both came.

    `others`: frames that would do as well, by the evidence; `grounded`: whether ground tells it.
    """

    frame: str
    turn: Floats
    notes: list[str]
    others: tuple[str, ...] = ()
    grounded: bool = False


def seems(xyz: Floats) -> Up:
    """The frame that points (P, 3) seem to be in."""
    cells = Cells.of(xyz)
    ground = find_ground(cells)
    rest = cells if ground is None else cells.take(~ground.cells)
    return find_frame(rest, local_wood(rest), ground)


def find_stance(xyz: Floats, frame: str = "auto", because: str = "") -> Stance:
    """How the points (P, 3) of a file stand in a named frame; auto: as the cloud shows.

    because: why it is that frame, where nobody asked for it. Only `auto` levels: a name says which
    axis is up. The row is looked for where the frame does not say where it runs.
    """
    cells = Cells.of(xyz)
    ground = find_ground(cells)
    rest = cells if ground is None else cells.take(~ground.cells)
    wood = local_wood(rest)
    up = find_frame(rest, wood, ground)
    notes = [_told(up)] if frame == "auto" else [because] if because else _doubts(frame, up)
    others = up.others if frame == "auto" else ()
    grounded = ground is not None
    told, level = frame != "auto", np.eye(3)
    frame = frame if told else up.frame
    if not told and ground is not None:
        level, tilt = levelling(ground.turned(FRAMES[frame]))
        if tilt:
            notes.append(f"levelled by {tilt:.0f} degrees: so far the ground is tilted")
    if told and frame in ROW_TOLD:
        return Stance(frame=frame, turn=level, notes=notes, others=others, grounded=grounded)
    house = level @ FRAMES[frame]
    angle = row_turn(rest.turned(house), wood.turned(house))
    if angle:
        viewer = house @ -cells.middle
        angle = _facing(angle, viewer)
        notes.append(f"turned by {math.degrees(angle):.0f} degrees about Z, to the row")
    return Stance(
        frame=frame,
        turn=turned(np.array([0.0, 0.0, angle])) @ level,
        notes=notes,
        others=others,
        grounded=grounded,
    )


def _facing(angle: float, viewer: Floats) -> float:
    """The turn to the row or half a turn on, such that the viewer (3,) is at smaller Y.

    Only where the row lies across X, so that neither is the natural one.
    """
    across = abs(angle) > math.pi / 4
    behind = math.sin(angle) * viewer[0] + math.cos(angle) * viewer[1] > 0
    if across and behind and np.linalg.norm(viewer) < VIEWER_M:
        return angle - math.copysign(math.pi, angle)
    return angle


def _told(up: Up) -> str:
    if not up.others:
        return f"frame {up.frame}: {up.why}"
    others = " or ".join(f"--frame {name}" for name in up.others)
    return f"undecided which axis is up: frame {up.frame} was taken ({up.why}); or say {others}"


def _doubts(frame: str, up: Up) -> list[str]:
    """What speaks against a frame that was asked for."""
    if up.others or np.allclose(FRAMES[frame][2], FRAMES[up.frame][2]):
        return []
    return [f"frame {frame} as asked, but the cloud looks like {up.frame}: {up.why}"]
