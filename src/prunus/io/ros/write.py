"""MCAP, the bag of ROS 2: the tree as markers, the cuts as poses, the cloud; no ROS needed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.files.safely import write_bytes
from prunus.io.skeletons.cylinders import Cylinders
from prunus.io.skeletons.export import COLOURS
from prunus.model import Bools, Floats, Label, Skeleton
from prunus.model.arrays import Bytes

FRAME = "map"
"""The name of the frame of the input file."""

TIME = 10**9
"""Nanoseconds: when all of it is said. Always the same, so that the same tree is the same file."""

TOPICS = {
    "/tree": "visualization_msgs/msg/MarkerArray",
    "/cuts": "geometry_msgs/msg/PoseArray",
    "/cuts/review": "geometry_msgs/msg/PoseArray",
    "/cuts/ids": "visualization_msgs/msg/MarkerArray",
    "/cloud": "sensor_msgs/msg/PointCloud2",
}
CYLINDER, TEXT = 3, 9
"""Types of markers."""

TEXT_HEIGHT_M = 0.02
FREE, LOOKED_AT = (0, 158, 115), (213, 94, 0)
"""Colours of the ids of cuts, which poses have no room for."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CutPoses:
    """Cuts with their ids: places (C, 3), orientations (C, 4) as unit quaternions x y z w.

    review (C,): a person looks first.
    """

    ids: list[str]
    places: Floats
    turns: Floats
    review: Bools


def write_mcap(
    path: str | Path,
    skeleton: Skeleton,
    cloud: tuple[Floats, Bytes | None] | None = None,
    cuts: CutPoses | None = None,
) -> None:
    """Write a skeleton, whose radii are known, and what else there is, in one message each.

    cloud: points (P, 3) and colours (P, 3) or None. Cuts that a person looks at first are in a
    topic of their own. All in metres and in the frame of the input file.
    """
    rosbag2, store = _rosbags(path)
    write = _Words(store)
    said = {"/tree": write.markers(skeleton)}
    if cuts is not None:
        free = ~cuts.review
        said["/cuts"] = write.poses(cuts.places[free], cuts.turns[free])
        said["/cuts/review"] = write.poses(cuts.places[cuts.review], cuts.turns[cuts.review])
        said["/cuts/ids"] = write.ids(cuts)
    if cloud is not None:
        said["/cloud"] = write.cloud(*cloud)
    with TemporaryDirectory() as folder:
        bag = Path(folder) / "tree"
        with rosbag2.Writer(bag, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP) as writer:
            for topic, message in said.items():
                kind = TOPICS[topic]
                connection = writer.add_connection(topic, kind, typestore=store)
                writer.write(connection, TIME, store.serialize_cdr(message, kind))
        write_bytes(Path(path), (bag / "tree.mcap").read_bytes())


def _rosbags(path: str | Path) -> tuple[Any, Any]:
    try:
        from rosbags import rosbag2
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise PrunusError(
            f"{path}: bags are written with rosbags, which is not installed: "
            "pip install 'prunus[bags]'"
        ) from error
    return rosbag2, get_typestore(Stores.ROS2_HUMBLE)


class _Words:
    """Messages of ROS 2 from arrays."""

    def __init__(self, store: Any) -> None:
        self.types = store.types
        stamp = self.new("builtin_interfaces/Time", sec=TIME // 10**9, nanosec=TIME % 10**9)
        self.header = self.new("std_msgs/Header", stamp=stamp, frame_id=FRAME)

    def new(self, name: str, /, **values: Any) -> Any:
        """A message of a package and type."""
        return self.types[name.replace("/", "/msg/")](**values)

    def markers(self, skeleton: Skeleton) -> Any:
        """A cylinder an edge, its namespace the label, its number the row of the skeleton."""
        made = Cylinders.of(skeleton)
        poses = self._poses((made.start + made.end) / 2, turned_from_z(made.axis))
        sizes = np.column_stack([2 * made.radius, 2 * made.radius, made.length]).tolist()
        markers = []
        for row, (pose, size) in enumerate(zip(poses, sizes, strict=True), 1):
            label = Label(skeleton.label[row])
            markers.append(
                self._marker(
                    label.word, row, CYLINDER, pose, size=size, colour=COLOURS[label], text=""
                )
            )
        return self.new("visualization_msgs/MarkerArray", markers=markers)

    def ids(self, cuts: CutPoses) -> Any:
        """The id of each cut as a text at its place.

        The namespace is the topic that has its pose, the number the place of the pose in that.
        """
        count = {False: 0, True: 0}
        markers = []
        poses = self._poses(cuts.places, cuts.turns)
        for text, pose, review in zip(cuts.ids, poses, cuts.review.tolist(), strict=True):
            topic, colour = ("/cuts/review", LOOKED_AT) if review else ("/cuts", FREE)
            size = [0.0, 0.0, TEXT_HEIGHT_M]
            number = count[review]
            markers.append(
                self._marker(topic, number, TEXT, pose, size=size, colour=colour, text=text)
            )
            count[review] += 1
        return self.new("visualization_msgs/MarkerArray", markers=markers)

    def _marker(
        self, space: str, number: int, kind: int, pose: Any, *, size: list[float],
        colour: tuple[int, int, int], text: str,
    ) -> Any:  # fmt: skip
        shares = dict(zip("rgb", (value / 255 for value in colour), strict=True))
        none = np.zeros(0, np.uint8)
        return self.new(
            "visualization_msgs/Marker", header=self.header, ns=space, id=number, type=kind,
            action=0, pose=pose, text=text, frame_locked=False,
            scale=self.new("geometry_msgs/Vector3", **dict(zip("xyz", size, strict=True))),
            color=self.new("std_msgs/ColorRGBA", a=1.0, **shares),
            lifetime=self.new("builtin_interfaces/Duration", sec=0, nanosec=0),
            points=[], colors=[], uv_coordinates=[], texture_resource="", mesh_resource="",
            texture=self.new(
                "sensor_msgs/CompressedImage", header=self.header, format="", data=none
            ),
            mesh_file=self.new("visualization_msgs/MeshFile", filename="", data=none),
            mesh_use_embedded_materials=False,
        )  # fmt: skip

    def poses(self, xyz: Floats, turns: Floats) -> Any:
        """A pose a cut."""
        return self.new(
            "geometry_msgs/PoseArray", header=self.header, poses=self._poses(xyz, turns)
        )

    def cloud(self, xyz: Floats, rgb: Bytes | None) -> Any:
        """Points in single precision, as viewers want them, and their colours, if any."""
        names = ["x", "y", "z"] if rgb is None else ["x", "y", "z", "rgb"]
        table = np.zeros((len(xyz), len(names)), "<f4")
        table[:, :3] = xyz
        if rgb is not None:
            packed = rgb.astype("<u4") @ np.array([1 << 16, 1 << 8, 1], "<u4")
            table[:, 3] = packed.astype("<u4").view("<f4")
        fields = [
            self.new("sensor_msgs/PointField", name=name, offset=4 * k, datatype=7, count=1)
            for k, name in enumerate(names)
        ]
        return self.new(
            "sensor_msgs/PointCloud2", header=self.header, height=1, width=len(xyz), fields=fields,
            is_bigendian=False, point_step=4 * len(names), row_step=4 * table.size,
            data=table.view(np.uint8).reshape(-1), is_dense=True,
        )  # fmt: skip

    def _poses(self, xyz: Floats, turns: Floats) -> list[Any]:
        return [
            self.new(
                "geometry_msgs/Pose",
                position=self.new("geometry_msgs/Point", **dict(zip("xyz", place, strict=True))),
                orientation=self.new(
                    "geometry_msgs/Quaternion", **dict(zip("xyzw", turn, strict=True))
                ),
            )
            for place, turn in zip(xyz.tolist(), turns.tolist(), strict=True)
        ]


def turned_from_z(axis: Floats) -> Floats:
    """The least rotations (C, 4), unit quaternions x y z w, that turn Z to unit vectors (C, 3)."""
    turns = np.column_stack([-axis[:, 1], axis[:, 0], np.zeros(len(axis)), 1 + axis[:, 2]])
    turns[axis[:, 2] < -1 + 1e-12] = (1, 0, 0, 0)
    return np.asarray(turns / np.linalg.norm(turns, axis=1, keepdims=True))


def facing(normal: Floats, direction: Floats) -> Floats:
    """Orientations (C, 4) with Z along unit normals (C, 3) and X along directions square to them.

    Where a direction is zero, X lies anywhere.
    """
    least = turned_from_z(normal)
    x, y, z, w = least.T
    across = np.column_stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)])
    sine = (np.cross(across, direction) * normal).sum(axis=1)
    half = np.arctan2(sine, (across * direction).sum(axis=1))[:, None] / 2
    about, still = np.sin(half) * normal, np.cos(half)
    vector = still * least[:, :3] + w[:, None] * about + np.cross(about, least[:, :3])
    return np.column_stack([vector, still[:, 0] * w - (about * least[:, :3]).sum(axis=1)])
