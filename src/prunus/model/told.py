"""What is told of a tree that grew on the votes of a point field, beside its skeleton."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from prunus.model.arrays import Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class Told:
    """By row of the skeleton, and of the scan as a whole.

    role (M, 6): probabilities, in the order of `Role`; scatter (M,): how far the votes for a node
    lie from it, metres; whole: numbers by name, see `growth.told`.
    """

    role: Floats
    scatter: Floats
    whole: Mapping[str, float]
