"""A scan of the wide orchard: a pure function of its seed."""

from __future__ import annotations

import numpy as np

from prunus.lab.simulate.row import NONE, Row
from prunus.lab.simulate.scan import Scan, scan_row
from prunus.lab.simulate.settings import scan_settings
from prunus.lab.simulate.wide.faults import spoiled
from prunus.lab.simulate.wide.plant import ground_points, plant_wide
from prunus.lab.simulate.wide.scanners import Seen, scan_with
from prunus.lab.simulate.wide.settings import (
    Surroundings,
    chosen,
    even,
    happens,
    wide_orchard,
)
from prunus.lab.simulate.wide.surface import loose, sample_pieces
from prunus.model import Kind

SPACING_M = 0.0022  # distance of surface samples
GROUND_SPACING_M = 0.008
SOIL = -2  # the piece of points on the ground
FIELD_SHARE = 0.7  # of the scans of the paper's rig, those with all its faults


def simulate_wide(seed: int) -> Scan:
    """The scan of that seed: trees, surroundings, scanner and faults drawn from `wide.toml`."""
    rng = np.random.default_rng([seed, 1])
    orchard = wide_orchard()
    row = plant_wide(rng, orchard)
    name = chosen(rng, {name: scanner.share for name, scanner in orchard.scanner.items()})
    if name == "rig":
        return scan_row(row, rng, scan_settings("hard" if happens(rng, FIELD_SHARE) else "clean"))
    surface = sample_pieces(rng, row.pieces, SPACING_M)
    soil = loose(ground_points(rng, orchard.around, row, GROUND_SPACING_M), SOIL)
    surface = surface.joined(soil)
    surface = surface.take(_in_the_open(rng, surface.xyz[:, 2], surface.piece, orchard.around))
    seen = scan_with(rng, name, orchard.scanner[name], surface, row.pieces)
    return _labelled(spoiled(rng, seen, orchard.faults), row)


def _in_the_open(
    rng: np.random.Generator, height: np.ndarray, piece: np.ndarray, around: Surroundings
) -> np.ndarray:
    """Weeds hide the lowest wood: which points they leave."""
    if not happens(rng, around.weeds):
        return np.ones(len(height), np.bool_)
    return np.asarray((height > even(rng, around.hidden)) | (piece == SOIL))


def _labelled(seen: Seen, row: Row) -> Scan:
    """The truth of each point, looked up in the pieces of the row."""
    owned = seen.piece >= 0
    piece = np.maximum(seen.piece, 0)
    kind = np.where(owned, row.pieces.kind[piece], Kind.STRAY)
    kind[seen.piece == SOIL] = Kind.GROUND
    tree = np.where(owned, row.pieces.tree[piece], NONE)
    node = np.where(owned, row.pieces.row[piece], NONE)
    return Scan(xyz=seen.xyz, kind=kind, tree=tree, node=node, row=row, views=(), focal=0.0)
