"""Points from the messages of sensors: ROS point clouds and depth images, as rosbags gives them."""

from __future__ import annotations

from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.io.clouds.columns import Columns, columns_of, unpacked
from prunus.model import Floats

KINDS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""Number types of the fields of a PointCloud2, by their number there."""

DEPTHS = {"16UC1": ("u2", 0.001), "mono16": ("u2", 0.001), "32FC1": ("f4", 1.0)}
"""Encodings of depth images: the type of a pixel, and metres in one unit."""

LENSES = ("", "plumb_bob", "rational_polynomial")
"""Distortion models that are taken out; others only where all their numbers are zero."""

ROUNDS = 20
"""Fixed-point rounds that take out the distortion of a lens."""


def cloud_points(message: Any, named: str) -> Columns:
    """All points of a `sensor_msgs/PointCloud2`: xyz (P, 3) in its frame, rgb (P, 3) or None.

    Points that saw nothing are there as NaN. `named` is what an error calls the message.
    """
    table = _grid(message, message.row_step, _fields(message, named), named).reshape(-1)
    names = table.dtype.names or ()
    xyz, rgb = columns_of(table, names, named)
    packed = next((name for name in ("rgb", "rgba") if name in names), None)
    return xyz, unpacked(table[packed]) if packed is not None else rgb


def depth_points(image: Any, info: Any, rectified: bool, named: str) -> Floats:
    """The pixels of a depth `sensor_msgs/Image` as points (P, 3) in the camera's optical frame.

    Pixels that saw nothing (0, NaN, infinity) are there as NaN. `info` is the camera's
    `sensor_msgs/CameraInfo`: a rectified image goes by its P, any other by its K and distortion.
    """
    if image.encoding not in DEPTHS:
        raise PrunusError(
            f"{named}: the image is {image.encoding!r}; expected depth, {' or '.join(DEPTHS)}"
        )
    if (image.width, image.height) != (info.width, info.height):
        raise PrunusError(
            f"{named}: the image has {image.width} x {image.height} pixels, its camera info is for "
            f"{info.width} x {info.height}; expected the same"
        )
    kind, unit = DEPTHS[image.encoding]
    grid = _grid(image, image.step, np.dtype(_order(image) + kind), named)
    depth = grid.astype(np.float64).reshape(-1) * unit
    depth[~(np.isfinite(depth) & (depth > 0))] = np.nan
    rays = _rays(info, rectified, named)
    return np.column_stack([rays * depth[:, None], depth])


def camera_matrix(info: Any, rectified: bool) -> Floats:
    """fx, fy, cx, cy of a `sensor_msgs/CameraInfo`, pixels; from P where rectified, else from K."""
    projection = np.asarray(_of(info, "p"), np.float64).reshape(3, 4)[:, :3]
    if not rectified or projection[0, 0] == 0:
        projection = np.asarray(_of(info, "k"), np.float64).reshape(3, 3)
    return projection[[0, 1, 0, 1], [0, 1, 2, 2]]


def _rays(info: Any, rectified: bool, named: str) -> Floats:
    """The slopes x / z and y / z (P, 2) of every pixel, row by row."""
    fx, fy, cx, cy = camera_matrix(info, rectified)
    if fx <= 0 or fy <= 0:
        raise PrunusError(
            f"{named}: the camera info says fx {fx:g}, fy {fy:g}; expected more than 0"
        )
    v, u = np.mgrid[: info.height, : info.width].reshape(2, -1)
    seen = np.column_stack([(u - cx) / fx, (v - cy) / fy])
    lens = np.asarray(_of(info, "d"), np.float64)
    if rectified or not lens.any():
        return seen
    if info.distortion_model not in LENSES:
        raise PrunusError(
            f"{named}: the lens is {info.distortion_model!r}; expected a rectified image, "
            f"or one of {', '.join(LENSES[1:])}"
        )
    return undistorted(seen, lens)


def undistorted(seen: Floats, lens: Floats) -> Floats:
    """Rays (P, 2) that a lens with k1 k2 p1 p2 [k3 [k4 k5 k6]] turned into those `seen`."""
    k1, k2, p1, p2, k3, k4, k5, k6 = np.pad(lens[:8], (0, max(0, 8 - len(lens))))
    x, y = seen.T
    for _ in range(ROUNDS):
        r2 = x * x + y * y
        swell = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
        aside = 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        along = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
        x, y = (seen[:, 0] - aside) / swell, (seen[:, 1] - along) / swell
    return np.column_stack([x, y])


def _fields(cloud: Any, named: str) -> np.dtype[Any]:
    """The row type of a PointCloud2: its number fields, and colours packed in four bytes."""
    fields = {
        field.name: (_order(cloud) + KINDS[field.datatype], field.offset)
        for field in cloud.fields
        if field.datatype in KINDS and field.count <= 1
    }
    for name in {"rgb", "rgba"} & set(fields):
        fields[name] = (_order(cloud) + "u4", fields[name][1])
    for name, (kind, offset) in fields.items():
        if offset + np.dtype(kind).itemsize > cloud.point_step:
            raise PrunusError(
                f"{named}: the field {name!r} ends after the {cloud.point_step} bytes of a point"
            )
    for name in sorted({"x", "y", "z"} & set(fields)):
        if fields[name][0][1] != "f":
            raise PrunusError(f"{named}: the field {name!r} holds whole numbers; expected floats")
    formats, offsets = zip(*fields.values(), strict=True) if fields else ((), ())
    kinds = {"names": list(fields), "formats": formats, "offsets": offsets}
    return np.dtype({**kinds, "itemsize": cloud.point_step})  # type: ignore[call-overload,no-any-return]


def _grid(message: Any, step: int, kind: np.dtype[Any], named: str) -> Any:
    """The rows and columns (height, width) of a cloud or an image, whatever its padding."""
    step = max(step, message.width * kind.itemsize)
    needed = (message.height - 1) * step + message.width * kind.itemsize
    if message.height * message.width and len(message.data) < needed:
        raise PrunusError(
            f"{named}: truncated: {message.width} x {message.height} need {needed} bytes, "
            f"the message holds {len(message.data)}"
        )
    if not message.height * message.width:
        return np.empty((0, 0), kind)
    shape, strides = (message.height, message.width), (step, kind.itemsize)
    return np.ndarray(shape, kind, np.ascontiguousarray(message.data), 0, strides)


def _order(message: Any) -> str:
    return ">" if message.is_bigendian else "<"


def _of(info: Any, letter: str) -> Any:
    """A matrix of a camera info: ROS 1 has it in a capital, ROS 2 in a small letter."""
    return getattr(info, letter if hasattr(info, letter) else letter.upper())
