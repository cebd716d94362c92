"""Units of length: those that a user may name, and those that headers tell."""

from __future__ import annotations

from typing import Literal

from prunus.errors import PrunusError

Unit = Literal["m", "cm", "mm", "ft", "us-ft", "in"]
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "us-ft": 1200 / 3937, "in": 0.0254}
"""Metres in one unit."""

CALLED = {
    "m": ("metre", "meter", "metres", "meters"),
    "cm": ("centimetre", "centimeter", "centimetres", "centimeters"),
    "mm": ("millimetre", "millimeter", "millimetres", "millimeters"),
    "ft": ("foot", "feet", "international foot"),
    "us-ft": ("us survey foot", "us survey feet", "us_ft", "usft", "ftus"),
    "in": ("inch", "inches"),
}
"""What else they are called."""

SAME = 1e-7
"""Units whose metres differ by less than this share are the same; the two feet differ by 2e-6."""


def metres_in(unit: str) -> float:
    """Metres in a unit that a user named; PrunusError where it is none."""
    if unit not in UNITS:
        raise PrunusError(f"unknown unit {unit!r}; expected one of {', '.join(UNITS)}")
    return UNITS[unit]


def unit_called(word: str) -> float | None:
    """Metres in a unit by any of its names; None where it is none."""
    word = " ".join(word.lower().split())
    return next((UNITS[u] for u, words in CALLED.items() if word == u or word in words), None)


def known(metres: float) -> float:
    """The length of the unit that so many metres are: headers round them."""
    same = (length for length in UNITS.values() if abs(metres / length - 1) < SAME)
    return next(same, metres)


def unit_of(metres: float) -> str:
    """The name of a unit of so many metres."""
    same = (unit for unit, length in UNITS.items() if abs(metres / length - 1) < SAME)
    return next(same, f"{metres:g} m")
