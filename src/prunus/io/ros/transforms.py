"""Where sensors stood: the tree of transforms that a recording holds on `tf` and `tf_static`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.model import Floats
from prunus.model.arrays import Ints
from prunus.model.cloud import RigidMotion

REACH = 10**9
"""Nanoseconds before its first and after its last sample for which a moving transform holds."""


Sample = tuple[bool, str, int, list[float]]
"""Of a transform: whether static, the parent, the time (ns), x y z (m) and x y z w of its turn."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Joint:
    """A frame in its parent: samples at time (S,) ns, place (S, 3) m, turn (S, 4) x y z w."""

    parent: str
    time: Ints
    place: Floats
    turn: Floats

    @property
    def moves(self) -> bool:
        """Whether the samples differ."""
        return bool((self.place != self.place[0]).any() or (self.turn != self.turn[0]).any())

    def at(self, time: int) -> RigidMotion | None:
        """The motion into the parent at a time, between two samples in proportion.

        None where the transform moves and no sample is within `REACH`.
        """
        if not self.moves:
            return RigidMotion(rotation(self.turn[0]), self.place[0])
        if not self.time[0] - REACH <= time <= self.time[-1] + REACH:
            return None
        after = int(np.clip(np.searchsorted(self.time, time), 1, len(self.time) - 1))
        begin, end = (int(self.time[row]) for row in (after - 1, after))
        share = float(np.clip((time - begin) / max(end - begin, 1), 0, 1))
        place = (1 - share) * self.place[after - 1] + share * self.place[after]
        turn = between(self.turn[after - 1], self.turn[after], share)
        return RigidMotion(rotation(turn), place)


@dataclass(frozen=True, eq=False)
class Transforms:
    """Frames by name, each with its joint to its parent; a frame without one is a root."""

    joints: dict[str, Joint]

    @classmethod
    def from_messages(
        cls, messages: Iterable[tuple[bool, Any]], frames: Iterable[str], named: str
    ) -> Transforms:
        """The joints above these frames, from `tf2_msgs/TFMessage`s, each with whether static.

        PrunusError, naming the frame, where one has two parents or a turn that is none.
        """
        samples: dict[str, list[Sample]] = {}
        for static, message in messages:
            for told in message.transforms:
                child = told.child_frame_id.strip("/")
                samples.setdefault(child, []).append(_sample(static, told))
        joints: dict[str, Joint] = {}
        waiting = list(frames)
        while waiting:
            child = waiting.pop()
            if child in samples and child not in joints:
                joints[child] = _joint(child, samples[child], named)
                waiting.append(joints[child].parent)
        return cls(joints)

    def above(self, frame: str) -> list[str]:
        """The frame and those above it, up to the root; a loop ends where it closes."""
        chain = [frame]
        while chain[-1] in self.joints and self.joints[chain[-1]].parent not in chain:
            chain.append(self.joints[chain[-1]].parent)
        return chain

    def moves(self, frame: str) -> bool:
        """Whether the frame moves in its root."""
        return any(self.joints[one].moves for one in self.above(frame)[:-1])

    def to_root(self, frame: str, time: int) -> RigidMotion | None:
        """The motion from a frame into its root at a time (ns); None where that is not known."""
        whole = RigidMotion(np.eye(3), np.zeros(3))
        for one in self.above(frame)[:-1]:
            step = self.joints[one].at(time)
            if step is None:
                return None
            whole = RigidMotion(step.rotation @ whole.rotation, step.apply(whole.translation))
        return whole


def _sample(static: bool, told: Any) -> Sample:
    place, turn = told.transform.translation, told.transform.rotation
    numbers = [place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w]
    return static, frame_of(told), time_of(told), numbers


def _joint(child: str, rows: list[Sample], named: str) -> Joint:
    rows = [row for row in rows if not row[0]] or rows[-1:]
    parents = sorted({parent for _, parent, _, _ in rows})
    if len(parents) > 1:
        raise PrunusError(
            f"{named}: the frame {child!r} hangs on {' and on '.join(map(repr, parents))}; "
            "expected one parent (tf, tf_static)"
        )
    time = np.array([row[2] for row in rows], np.int64)
    numbers = np.array([row[3] for row in rows], np.float64)
    order = np.argsort(time, kind="stable")
    length = np.linalg.norm(numbers[:, 3:], axis=1, keepdims=True)
    if not (np.isfinite(numbers).all() and (length > 0.5).all()):
        raise PrunusError(
            f"{named}: the transform from {child!r} to {parents[0]!r} is none; "
            "expected finite numbers and a unit quaternion"
        )
    return Joint(
        parent=parents[0],
        time=time[order],
        place=numbers[order, :3],
        turn=(numbers[:, 3:] / length)[order],
    )


def rotation(turn: Floats) -> Floats:
    """The rotation matrix (3, 3) of a unit quaternion x y z w."""
    x, y, z, w = turn
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def between(begin: Floats, end: Floats, share: float) -> Floats:
    """The unit quaternion at a share (0 to 1) of the shorter arc from one to another (slerp)."""
    cosine = float(begin @ end)
    end, cosine = (-end, -cosine) if cosine < 0 else (end, cosine)
    angle = float(np.arccos(min(cosine, 1.0)))
    if angle < 1e-6:
        turn = (1 - share) * begin + share * end
    else:
        turn = np.sin((1 - share) * angle) * begin + np.sin(share * angle) * end
    return np.asarray(turn / np.linalg.norm(turn))


def frame_of(message: Any) -> str:
    """The frame that a message's header names, without the leading slash of old."""
    return str(message.header.frame_id).strip("/")


def time_of(message: Any) -> int:
    """The stamp of a message's header, nanoseconds; 0 where it has none."""
    stamp = message.header.stamp
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)
