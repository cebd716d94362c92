"""Point clouds from recordings: ROS 1 bags, ROS 2 bags (SQLite, MCAP), no ROS needed.

A topic of `sensor_msgs/PointCloud2` is taken as it is, a topic of depth `sensor_msgs/Image`s goes
through the `CameraInfo` beside it; several messages are joined where `tf` says the sensor stood.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.files.safely import check_readable, parsing, plainly_named
from prunus.io.clouds.columns import Columns
from prunus.io.inputs import Source
from prunus.io.ros.messages import cloud_points, depth_points
from prunus.io.ros.topics import CLOUD, TRANSFORMS, camera_of, chosen, counted, messages
from prunus.io.ros.transforms import Transforms, frame_of, time_of
from prunus.io.ros.views import View, placed
from prunus.model import Floats
from prunus.model.arrays import Bytes

MOST = 10_000_000
"""Points that are joined at most; of a longer recording every second, fourth ... message is."""


def read_bag(source: Source) -> tuple[Floats, Bytes | None, list[str]]:
    """The points (P, 3) of a recording in metres, colours (P, 3) or None, notes on what was joined.

    In the frame of the sensor where one message is taken or the sensor stands still, else in the
    root of the transforms. PrunusError lists the topics where the choice is not plain, and names
    the frames that no transform connects.
    """
    named = str(source.full)
    check_readable(source.path)
    reader, types = _rosbags(named)
    with (
        parsing(named, "bag"),
        plainly_named(source.path) as path,
        reader([path], default_typestore=types) as bag,
    ):
        return _read(bag, source.topic, named)


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
    topic = chosen(bag, wanted, named)
    views, taken = _views(bag, topic, f"{named} {topic}" if wanted is None else named)
    if not views:
        raise PrunusError(f"{named}: no message on {topic}, though the index promises some")
    parts, where = placed(views, _transforms(bag, views, named), named)
    xyz = np.concatenate([xyz for xyz, _ in parts])
    colours = [rgb for _, rgb in parts if rgb is not None]
    rgb = np.concatenate(colours) if len(colours) == len(parts) else None
    lost = sum(view.lost for view in views)
    whole = lost + sum(len(view.xyz) for view in views)
    dark = [f"{lost} of {whole} points saw nothing (NaN) and were left out"] if lost else []
    return xyz, rgb, [f"topic {topic}: {taken}", *where, *dark]


def _transforms(bag: Any, views: list[View], named: str) -> Transforms:
    """The joints above the frames of the views; none where a single view needs none."""
    topics = [n for n, t in bag.topics.items() if t.msgtype in TRANSFORMS and t.msgcount]
    if len(views) == 1 or not topics:
        return Transforms({})
    told = messages(bag, *topics)
    static = ((c.topic.endswith("tf_static"), message) for (c, _), message in told)
    return Transforms.from_messages(static, {view.frame for view in views}, named)


def _views(bag: Any, topic: str, named: str) -> tuple[list[View], str]:
    """What the messages of a topic saw, and how many were taken.

    Whenever they hold more than `MOST` points, every second goes, and of the rest to come too.
    """
    points = _points_of(bag, topic, named)
    every, views = 1, list[View]()
    for number, ((_, time), message) in enumerate(messages(bag, topic)):
        if number % every == 0:
            views.append(_view(*points(message), message, time))
        if sum(len(view.xyz) for view in views) > MOST:
            views, every = views[::2], every * 2
    count = bag.topics[topic].msgcount
    sparse = f", one in {every} of {count}: more would hold over {MOST} points"
    return views, f"{counted(len(views))} joined" + sparse * (len(views) < count)


def _view(xyz: Floats, rgb: Bytes | None, message: Any, time: int) -> View:
    """The points that a message saw; `time` (ns) in the bag counts where it has no stamp."""
    seen = np.isfinite(xyz).all(axis=1)
    rgb = None if rgb is None else rgb[seen]
    when = time_of(message) or time
    return View(xyz=xyz[seen], rgb=rgb, frame=frame_of(message), time=when, lost=int((~seen).sum()))


def _points_of(bag: Any, topic: str, named: str) -> Callable[[Any], Columns]:
    if bag.topics[topic].msgtype == CLOUD:
        return lambda message: cloud_points(message, named)
    camera = camera_of(topic)
    if camera not in bag.topics or not bag.topics[camera].msgcount:
        raise PrunusError(f"{named}: no camera info for the image; expected the topic {camera}")
    info = next(messages(bag, camera))[1]
    return lambda image: (depth_points(image, info, "rect" in topic, named), None)
