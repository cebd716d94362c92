"""What single messages of a recording saw, put together in one frame."""

from __future__ import annotations

from dataclasses import dataclass

from prunus.errors import PrunusError
from prunus.io.clouds.columns import Columns
from prunus.io.ros.transforms import Transforms
from prunus.model import Floats
from prunus.model.arrays import Bytes


@dataclass(frozen=True, eq=False, kw_only=True)
class View:
    """What a message saw at a time (ns): xyz (P, 3) m in its sensor's frame, rgb (P, 3) or None.

    `lost` is how many of its points saw nothing.
    """

    xyz: Floats
    rgb: Bytes | None
    frame: str
    time: int
    lost: int


def placed(
    views: list[View], transforms: Transforms, named: str
) -> tuple[list[Columns], list[str]]:
    """The points of all views in one frame, and notes on which frame it is.

    It is that of the sensor where there is one view or no transform moves it, else the root.
    PrunusError where no transform connects the frames, or none is known at the time of any view.
    """
    frames = sorted({view.frame for view in views})
    if len(frames) == 1 and not (len(views) > 1 and transforms.moves(frames[0])):
        still = ", which no tf moves" if len(views) > 1 else ""
        where = f"in the frame {frames[0]!r} of the sensor{still}"
        return [(view.xyz, view.rgb) for view in views], [where]
    root = _root(frames, transforms, named)
    motions = [transforms.to_root(view.frame, view.time) for view in views]
    pairs = [(v, m) for v, m in zip(views, motions, strict=True) if m is not None]
    if not pairs:
        raise PrunusError(
            f"{named}: all {len(views)} messages lie more than a second before or after the "
            f"transforms to {root!r}; expected stamps of the same clock"
        )
    notes, lost = [f"in the frame {root!r}, through tf"], len(views) - len(pairs)
    if lost:
        notes.append(f"{lost} of {len(views)} messages left out: no tf within a second of them")
    return [(motion.apply(view.xyz), view.rgb) for view, motion in pairs], notes


def _root(frames: list[str], transforms: Transforms, named: str) -> str:
    roots = {frame: transforms.above(frame)[-1] for frame in frames}
    if len(set(roots.values())) > 1:
        told = ", ".join(f"{frame!r} leads up to {root!r}" for frame, root in roots.items())
        raise PrunusError(
            f"{named}: no transform connects the frames of the messages: {told}; "
            "expected tf and tf_static to lead to one root"
        )
    return roots[frames[0]]
