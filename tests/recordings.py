"""Real recordings, written with rosbags as a robot would: ROS 1, ROS 2 SQLite and MCAP."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

KINDS = ["ros1", "sqlite3", "mcap"]
SHORT = {
    "PointCloud2": "sensor_msgs",
    "PointField": "sensor_msgs",
    "Image": "sensor_msgs",
    "CameraInfo": "sensor_msgs",
    "RegionOfInterest": "sensor_msgs",
    "String": "std_msgs",
    "Header": "std_msgs",
    "Time": "builtin_interfaces",
    "TFMessage": "tf2_msgs",
    "TransformStamped": "geometry_msgs",
    "Transform": "geometry_msgs",
    "Vector3": "geometry_msgs",
    "Quaternion": "geometry_msgs",
}


@dataclass
class Recording:
    """Messages as they are gathered: topic, kind, time (s), message."""

    kind: str
    rows: list[tuple[str, str, float, Any]] = field(default_factory=list)

    @cached_property
    def store(self) -> Any:
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        if self.kind != "ros1":
            return get_typestore(Stores.ROS2_HUMBLE)
        store = get_typestore(Stores.ROS1_NOETIC)
        many = "geometry_msgs/TransformStamped[] transforms"
        store.register(get_types_from_msg(many, "tf2_msgs/msg/TFMessage"))
        return store

    def new(self, name: str, /, **values: Any) -> Any:
        return self.store.types[f"{SHORT[name]}/msg/{name}"](**values)

    def add(self, topic: str, name: str, time: float, message: Any) -> None:
        self.rows.append((topic, name, time, message))

    def header(self, frame: str, time: float) -> Any:
        nanoseconds = round(time * 1e9)
        stamp = self.new("Time", sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
        more = {"seq": 0} if self.kind == "ros1" else {}
        return self.new("Header", stamp=stamp, frame_id=frame, **more)

    def cloud(
        self, topic: str, table: Any, frame: str = "lidar", time: float = 1.0, pad: int = 0,
        height: int = 1, cut: int = 0,
    ) -> None:  # fmt: skip
        """A structured array (P,) as a PointCloud2, `pad` bytes behind every row."""
        numbers = {"u1": 2, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 8}
        fields = [
            self.new("PointField", name=n, offset=at, datatype=numbers[kind.str[1:]], count=1)
            for n, (kind, at) in table.dtype.fields.items()
        ]
        rows = table.reshape(height, -1)
        data = b"".join(row.tobytes() + b"\xff" * pad for row in rows)
        message = self.new(
            "PointCloud2", header=self.header(frame, time), height=height, width=rows.shape[1],
            fields=fields, is_bigendian=table.dtype[0].str[0] == ">",
            point_step=table.dtype.itemsize, row_step=rows.shape[1] * table.dtype.itemsize + pad,
            data=np.frombuffer(data[: len(data) - cut], np.uint8), is_dense=True,
        )  # fmt: skip
        self.add(topic, "PointCloud2", time, message)

    def image(
        self, topic: str, pixels: Any, encoding: str, frame: str = "eye", time: float = 1.0
    ) -> None:
        message = self.new(
            "Image", header=self.header(frame, time), height=len(pixels), width=len(pixels[0]),
            encoding=encoding, is_bigendian=int(pixels.dtype.str[0] == ">"),
            step=pixels.shape[1] * pixels.dtype.itemsize,
            data=np.frombuffer(pixels.tobytes(), np.uint8),
        )  # fmt: skip
        self.add(topic, "Image", time, message)

    def camera(
        self, topic: str, size: tuple[int, int], focus: float, lens: Sequence[float] = (),
        model: str = "plumb_bob",
    ) -> None:  # fmt: skip
        """The camera info of an image (height, width) whose axis meets its middle pixel."""
        height, width = size
        matrix = np.array([[focus, 0, width // 2], [0, focus, height // 2], [0, 0, 1.0]])
        letters = {
            "d": np.array(lens, np.float64),
            "k": matrix.reshape(-1),
            "r": np.eye(3).reshape(-1),
            "p": np.column_stack([matrix, np.zeros(3)]).reshape(-1),
        }
        if self.kind == "ros1":
            letters = {letter.upper(): values for letter, values in letters.items()}
        whole = self.new(
            "RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        message = self.new(
            "CameraInfo", header=self.header("eye", 1.0), height=height, width=width,
            distortion_model=model, binning_x=0, binning_y=0, roi=whole, **letters,
        )  # fmt: skip
        self.add(topic, "CameraInfo", 1.0, message)

    def joint(
        self, parent: str, child: str, place: Sequence[float],
        turn: Sequence[float] = (0, 0, 0, 1), time: float = 1.0, topic: str = "/tf_static",
    ) -> None:  # fmt: skip
        transform = self.new(
            "Transform",
            translation=self.new("Vector3", **dict(zip("xyz", map(float, place), strict=True))),
            rotation=self.new("Quaternion", **dict(zip("xyzw", map(float, turn), strict=True))),
        )
        told = self.new(
            "TransformStamped", header=self.header(parent, time), child_frame_id=child,
            transform=transform,
        )  # fmt: skip
        self.add(topic, "TFMessage", time, self.new("TFMessage", transforms=[told]))

    def word(self, topic: str, text: str) -> None:
        self.add(topic, "String", 1.0, self.new("String", data=text))

    def write(self, folder: Path, name: str = "rec") -> Path:
        """Write it all; the path of the .bag, or of the folder of the ROS 2 bag."""
        path = folder / (f"{name}.bag" if self.kind == "ros1" else name)
        serialize = self.store.serialize_ros1 if self.kind == "ros1" else self.store.serialize_cdr
        with self._writer(path) as writer:
            connections: dict[str, Any] = {}
            for topic, name, time, message in self.rows:
                kind = f"{SHORT[name]}/msg/{name}"
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, kind, typestore=self.store)
                writer.write(connections[topic], round(time * 1e9), serialize(message, kind))
        return path

    def _writer(self, path: Path) -> Any:
        if self.kind == "ros1":
            from rosbags.rosbag1 import Writer as Writer1

            return Writer1(path)
        from rosbags.rosbag2 import StoragePlugin, Writer

        return Writer(path, version=9, storage_plugin=StoragePlugin[self.kind.upper()])


def table_of(xyz: Any, kind: str = "<f4") -> Any:
    """Points (P, 3) as the plainest table of a PointCloud2."""
    table = np.zeros(len(xyz), [(axis, kind) for axis in "xyz"])
    for axis, name in enumerate("xyz"):
        table[name] = np.asarray(xyz)[:, axis]
    return table
