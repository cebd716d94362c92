"""Point clouds from recordings: ROS 1 bags, ROS 2 bags (SQLite, MCAP), no ROS needed.

A topic of `sensor_msgs/PointCloud2` is taken as it is, a topic of depth `sensor_msgs/Image`s goes
through the `CameraInfo` beside it; several messages are joined where `tf` says the sensor stood.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.io.inputs import Source
from prunus.io.messages import DEPTHS, cloud_points, depth_points
from prunus.io.readers import Columns
from prunus.io.safely import check_readable
from prunus.io.transforms import Transforms, frame_of, time_of
from prunus.model import Floats
from prunus.model.arrays import Bytes

CLOUD, IMAGE, CAMERA = (
    f"sensor_msgs/msg/{name}" for name in ("PointCloud2", "Image", "CameraInfo")
)
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")

MOST = 10_000_000
"""Points that are joined at most; of a longer recording every second, third ... message is."""


@dataclass(frozen=True, eq=False)
class View:
    """What a message saw at a time (ns): xyz (P, 3) m in its sensor's frame, rgb (P, 3) or None."""

    xyz: Floats
    rgb: Bytes | None
    frame: str
    time: int


def read_bag(source: Source) -> tuple[Floats, Bytes | None, list[str]]:
    """The points (P, 3) of a recording in metres, colours (P, 3) or None, notes on what was joined.

    In the frame of the sensor where one message is taken or the sensor stands still, else in the
    root of the transforms. PrunusError lists the topics where the choice is not plain, and names
    the frames that no transform connects.
    """
    named = str(source.full)
    check_readable(source.path)
    reader, types = _rosbags(named)
    # rosbags raises whatever its parsing trips over; the file is at fault in every case.
    try:
        with _plain(source.path) as path, reader([path], default_typestore=types) as bag:
            return _read(bag, source.topic, named)
    except PrunusError:
        raise
    except Exception as error:
        raise PrunusError(f"{named}: not a readable bag: {error}") from error


@contextmanager
def _plain(path: Path) -> Iterator[Path]:
    """The path, or a link to it where it holds what SQLite takes for marks of an address."""
    if not set("#?%") & set(str(path)):
        yield path
        return
    with TemporaryDirectory() as folder:
        link = Path(folder) / f"bag{path.suffix}"
        link.symlink_to(path.absolute())
        yield link


def _rosbags(named: str) -> tuple[Any, Any]:
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise PrunusError(
            f"{named}: bags are read with rosbags, which is not installed: "
            "pip install 'prunus[bags]'"
        ) from error
    return AnyReader, get_typestore(Stores.ROS2_HUMBLE)


def _read(bag: Any, wanted: str | None, named: str) -> tuple[Floats, Bytes | None, list[str]]:
    topic = _chosen(bag, wanted, named)
    transforms = _transforms(bag, named)
    views, taken = _views(bag, topic, f"{named} {topic}" if wanted is None else named)
    notes = [f"topic {topic}: {taken}"]
    placed = _placed(views, transforms, notes, named)
    xyz = np.concatenate([xyz for xyz, _ in placed])
    colours = [rgb for _, rgb in placed if rgb is not None]
    rgb = np.concatenate(colours) if len(colours) == len(placed) else None
    seen = np.isfinite(xyz).all(axis=1)
    if not seen.all():
        notes.append(f"{(~seen).sum()} of {len(xyz)} points saw nothing (NaN) and were left out")
    return xyz[seen], None if rgb is None else rgb[seen], notes


def _chosen(bag: Any, wanted: str | None, named: str) -> str:
    """The topic to read: the one wanted, the only clouds, or the only depth images."""
    topics: dict[str, str] = {
        name: told.msgtype for name, told in bag.topics.items() if told.msgcount
    }
    if wanted is not None:
        match = next((n for n in topics if n.strip("/") == wanted.strip("/")), None)
        if match is None or topics[match] not in (CLOUD, IMAGE):
            raise PrunusError(f"{named}: no such topic of clouds or images. {_listed(bag)}")
        return match
    clouds = [name for name, kind in topics.items() if kind == CLOUD]
    choice = clouds or [name for name in topics if _is_depth(bag, name)]
    if len(choice) == 1:
        return choice[0]
    kind = "point clouds" if clouds else "depth images with camera info"
    example = next(iter(choice), "/topic")
    raise PrunusError(
        f"{named}: {len(choice)} topics hold {kind}; expected one, or its name behind the "
        f"file's: '{named}#{example}'. {_listed(bag)}"
    )


def _listed(bag: Any) -> str:
    topics = sorted(bag.topics.items())
    rows = [f"{name} ({told.msgtype}, {_counted(told.msgcount)})" for name, told in topics]
    return f"The bag holds {'; '.join(rows) or 'no topics'}"


def _counted(messages: int) -> str:
    return "1 message" if messages == 1 else f"{messages} messages"


def _camera_of(topic: str) -> str:
    return topic.rpartition("/")[0] + "/camera_info"


def _is_depth(bag: Any, topic: str) -> bool:
    camera = bag.topics.get(_camera_of(topic))
    if bag.topics[topic].msgtype != IMAGE or camera is None or not camera.msgcount:
        return False
    return next(_messages(bag, topic))[1].encoding in set(DEPTHS) - {"mono16"}


def _messages(bag: Any, *topics: str) -> Iterator[tuple[Any, Any]]:
    """Of every message on these topics, in time: connection and time in the bag, and itself."""
    connections = [c for c in bag.connections if c.topic in topics]
    for connection, time, raw in bag.messages(connections=connections):
        yield (connection, time), bag.deserialize(raw, connection.msgtype)


def _transforms(bag: Any, named: str) -> Transforms:
    topics = [n for n, t in bag.topics.items() if t.msgtype in TRANSFORMS and t.msgcount]
    told = _messages(bag, *topics) if topics else iter(())
    static = ((c.topic.endswith("tf_static"), message) for (c, _), message in told)
    return Transforms.from_messages(static, named)


def _views(bag: Any, topic: str, named: str) -> tuple[list[View], str]:
    """What the messages of a topic saw, at most about `MOST` points, and how many were taken."""
    points = _points_of(bag, topic, named)
    count, every, views = bag.topics[topic].msgcount, 1, list[View]()
    for number, ((_, time), message) in enumerate(_messages(bag, topic)):
        if number == 0:
            every = max(1, -(-count * message.width * message.height // MOST))
        if number % every == 0:
            views.append(View(*points(message), frame_of(message), time_of(message) or time))
    sparse = f", one in {every} of {count}: all would hold more than {MOST} points"
    return views, f"{_counted(len(views))} joined" + sparse * (every > 1)


def _points_of(bag: Any, topic: str, named: str) -> Callable[[Any], Columns]:
    if bag.topics[topic].msgtype == CLOUD:
        return lambda message: cloud_points(message, named)
    camera = _camera_of(topic)
    if camera not in bag.topics or not bag.topics[camera].msgcount:
        raise PrunusError(f"{named}: no camera info for the image; expected the topic {camera}")
    info = next(_messages(bag, camera))[1]
    return lambda image: (depth_points(image, info, "rect" in topic, named), None)


def _placed(
    views: list[View], transforms: Transforms, notes: list[str], named: str
) -> list[Columns]:
    """The points of all views in one frame; how is added to the notes."""
    frames = sorted({view.frame for view in views})
    if len(views) == 1 or (len(frames) == 1 and not transforms.moves(frames[0])):
        notes.append(f"in the frame {frames[0]!r} of the sensor, which stands still")
        return [(view.xyz, view.rgb) for view in views]
    tops = {frame: transforms.above(frame)[-1] for frame in frames}
    if len(set(tops.values())) > 1:
        told = ", ".join(f"{frame!r} leads up to {top!r}" for frame, top in tops.items())
        raise PrunusError(
            f"{named}: no transform connects the frames of the messages: {told}; "
            "expected tf and tf_static to lead to one root"
        )
    motions = [transforms.to_root(view.frame, view.time) for view in views]
    pairs = [(v, m) for v, m in zip(views, motions, strict=True) if m is not None]
    _tell(notes, tops[frames[0]], len(views), len(views) - len(pairs), named)
    return [(motion.apply(view.xyz), view.rgb) for view, motion in pairs]


def _tell(notes: list[str], root: str, count: int, lost: int, named: str) -> None:
    """Note the frame of a joined cloud, and the messages at whose time no transform is known."""
    if lost == count:
        raise PrunusError(
            f"{named}: all {count} messages lie more than a second before or after the "
            f"transforms to {root!r}; expected stamps of the same clock"
        )
    notes.append(f"in the frame {root!r}, through tf")
    if lost:
        notes.append(f"{lost} of {count} messages left out: no tf within a second of them")
