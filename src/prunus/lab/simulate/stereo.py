"""What stereo matching does to a true depth image: it loses, fattens, flies, errs in blocks."""

from __future__ import annotations

import math

import numpy as np

from prunus.lab.simulate.depth import GROUND, NOTHING, fatten, fly
from prunus.lab.simulate.row import Pieces
from prunus.lab.simulate.settings import RigSettings, StereoSettings
from prunus.model import Bools, Floats, Ints

BLOB = 24
"""Size of the patches of an image in which the matcher does alike, pixels."""


def hold_of(rng: np.random.Generator, pieces: Pieces, settings: StereoSettings) -> Floats:
    """How well each piece (S,) holds in any view, 0 to 1: thin wood gives way in patches."""
    size = np.maximum(pieces.radius, 1e-4)
    firm = 1 / (1 + (settings.thin / size) ** 3)
    weak = settings.patchy * noise3(rng, (pieces.start + pieces.end) / 2, settings.patch)
    return np.asarray(firm - weak)


def matched(
    rng: np.random.Generator,
    depth: Floats,
    owner: Ints,
    hold: Floats,
    settings: StereoSettings,
    rig: RigSettings,
) -> tuple[Floats, Ints]:
    """Depth and owner (H, W) as the matcher of one view gives them, 0 and `NOTHING` elsewhere."""
    kept = _kept(rng, owner, hold, settings)
    depth, owner = np.where(kept, depth, 0.0), np.where(kept, owner, NOTHING)
    reach = np.rint(_between(noise2(rng, depth.shape, BLOB) ** 2, settings.reach)).astype(np.int64)
    depth, owner = fatten(depth, owner, reach)
    chance = rng.random(depth.shape) / max(settings.flying, 1e-9)
    fly(depth, 0.03, chance, rng.random(depth.shape) ** 3)
    return _disparity_errs(rng, depth, settings, rig), owner


def _kept(rng: np.random.Generator, owner: Ints, hold: Floats, settings: StereoSettings) -> Bools:
    """Which pixels (H, W) are matched at all."""
    view = noise2(rng, owner.shape, BLOB)
    wood = hold[np.maximum(owner, 0)] > settings.flicker * view
    soil = noise2(rng, owner.shape, 2 * BLOB) < settings.ground
    return np.asarray(np.where(owner == GROUND, soil, wood) & (owner != NOTHING))


def _disparity_errs(
    rng: np.random.Generator, depth: Floats, settings: StereoSettings, rig: RigSettings
) -> Floats:
    """The depth with its disparity in error, partly by blocks, and rounded to steps."""
    scale = focal_length(rig) * rig.baseline
    disparity = scale / np.where(depth > 0, depth, 1.0)
    block = settings.block_share * settings.subpixel**2
    disparity += math.sqrt(block) * _blocks(rng, depth.shape, settings.block)
    disparity += math.sqrt(settings.subpixel**2 - block) * rng.normal(size=depth.shape)
    disparity = np.maximum(np.rint(disparity / settings.step), 1) * settings.step
    return np.where(depth > 0, scale / disparity, 0.0)


def focal_length(rig: RigSettings) -> float:
    """Focal length, pixels."""
    return rig.height / 2 / math.tan(math.radians(rig.view) / 2)


def noise2(rng: np.random.Generator, shape: tuple[int, int], cell: float) -> Floats:
    """Smooth noise (H, W), about even from 0 to 1, in patches of so many pixels."""
    down, across = (_mixing(np.arange(size) / cell) for size in shape)
    return _spread(down @ rng.random((down.shape[1], across.shape[1])) @ across.T)


def noise3(rng: np.random.Generator, xyz: Floats, cell: float) -> Floats:
    """Value noise (S,) at points (S, 3), about even from 0 to 1, in patches of that size."""
    at = (xyz - xyz.min(axis=0)) / cell
    low = at.astype(np.int64)
    table, share = rng.random(low.max(axis=0) + 2), at - low
    total = np.zeros(len(xyz))
    for corner in np.ndindex(2, 2, 2):
        weight = np.where(corner, share, 1 - share).prod(axis=1)
        total += weight * table[tuple((low + corner).T)]
    return _spread(total)


def _mixing(at: Floats) -> Floats:
    """The matrix (S, C) that mixes C cells linearly into values at places (S,) among them."""
    return np.asarray(np.maximum(0, 1 - np.abs(at[:, None] - np.arange(int(at.max()) + 2))))


def _spread(values: Floats) -> Floats:
    """Mixing draws values to the middle; this draws them apart again."""
    return np.asarray(1 / (1 + np.exp(-9 * (values - 0.5))))


def _blocks(rng: np.random.Generator, shape: tuple[int, ...], size: int) -> Floats:
    """Normal noise (H, W), the same over blocks at a random offset."""
    offset = rng.integers(0, size, 2)
    rows, columns = ((np.arange(n) + o) // size for n, o in zip(shape, offset, strict=True))
    table = rng.normal(size=(int(rows[-1]) + 1, int(columns[-1]) + 1))
    return np.asarray(table[np.ix_(rows, columns)])


def _between(share: Floats, limits: tuple[float, float]) -> Floats:
    return limits[0] + share * (limits[1] - limits[0])
