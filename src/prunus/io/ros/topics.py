"""The topics of a recording: which one to read, and the messages on it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from prunus.errors import PrunusError
from prunus.io.ros.messages import DEPTHS

CLOUD, IMAGE = "sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/Image"
"""What can be read: the types of topics, by the names that rosbags gives them in ROS 1 and 2."""
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
"""What tells where frames are: the type of today, and that of the oldest bags."""


def chosen(bag: Any, wanted: str | None, named: str) -> str:
    """The topic to read: the one wanted, the only clouds, or the only depth images.

    PrunusError, which lists what the bag holds, where the wanted one is none or there are several.
    """
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
    rows = [f"{name} ({told.msgtype}, {counted(told.msgcount)})" for name, told in topics]
    return f"The bag holds {'; '.join(rows) or 'no topics'}"


def counted(number: int) -> str:
    """So many messages, in words."""
    return "1 message" if number == 1 else f"{number} messages"


def camera_of(topic: str) -> str:
    """The topic of the camera info that belongs to an image: its neighbour in the namespace."""
    return topic.rpartition("/")[0] + "/camera_info"


def _is_depth(bag: Any, topic: str) -> bool:
    camera = bag.topics.get(camera_of(topic))
    if bag.topics[topic].msgtype != IMAGE or camera is None or not camera.msgcount:
        return False
    return next(messages(bag, topic))[1].encoding in set(DEPTHS) - {"mono16"}


def messages(bag: Any, *topics: str) -> Iterator[tuple[Any, Any]]:
    """Of every message on these topics, in time: connection and time in the bag, and itself."""
    connections = [c for c in bag.connections if c.topic in topics]
    for connection, time, raw in bag.messages(connections=connections):
        yield (connection, time), bag.deserialize(raw, connection.msgtype)
