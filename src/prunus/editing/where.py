"""Choices of points of a scan, as values. All places are in the frame of the input file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field, PlainSerializer, PlainValidator

from prunus.editing.wire import Checked, KindWord, Length, Number, Point, read, told

Row = tuple[Number, Number, Number, Number]


@dataclass(frozen=True)
class Box(Checked):
    """The points between two corners."""

    low: Point
    high: Point


@dataclass(frozen=True)
class Slab(Checked):
    """What of the scan was shown: the points with low <= direction . xyz <= high."""

    direction: Point
    low: Number
    high: Number


@dataclass(frozen=True)
class Lasso(Checked):
    """The points seen inside a polygon (Q, 2) of the image that a 4x4 projection gives.

    The image of a point is (x / w, y / w) of projection @ (x, y, z, 1), where w > 0. With a slab,
    only those of it: nobody marks what was hidden.
    """

    polygon: Annotated[tuple[tuple[Number, Number], ...], Field(min_length=3)]
    projection: tuple[Row, Row, Row, Row]
    slab: Slab | None = None


@dataclass(frozen=True)
class Brush(Checked):
    """The points within a radius, metres, of any of these places."""

    centres: Annotated[tuple[Point, ...], Field(min_length=1)]
    radius: Length


@dataclass(frozen=True)
class Component(Checked):
    """The points that hang together, over gaps up to about `gap`, with the one nearest to a place.

    Only such as are of its kind now: what was taken out no longer joins two pieces.
    """

    place: Point
    gap: Length = 0.05


@dataclass(frozen=True)
class Class(Checked):
    """All points that are of a kind now."""

    kind: KindWord


Shape = Box | Lasso | Brush | Component | Class
SHAPES: tuple[type[Shape], ...] = (Box, Lasso, Brush, Component, Class)


def _read(value: Any) -> Shape:
    return read(value, "shape", SHAPES)


def _told(where: Shape) -> dict[str, Any]:
    return told(where, "shape")


Where = Annotated[Shape, PlainValidator(_read), PlainSerializer(_told)]
"""A choice of points as an act holds it."""
