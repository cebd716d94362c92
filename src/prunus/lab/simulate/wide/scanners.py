"""Scanners: what each sees of a surface, and how it errs (all but the paper's rig)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from prunus.lab.simulate.row import Pieces
from prunus.lab.simulate.stereo import noise3
from prunus.lab.simulate.wide.settings import Scanner, even, whole
from prunus.lab.simulate.wide.surface import Surface, seen_from
from prunus.model import Floats, Ints

MILLI = 1e-3  # a millimetre in metres, a milliradian in radians
EDGE_M = 0.03  # a pixel that holds surfaces so far apart may give a point between them
BEAM_SHARE = 0.25  # of the distance between the lines of a lidar, what each line sees
APART_M = 0.5  # stations on one side stand so far apart along the row


@dataclass(frozen=True, eq=False, kw_only=True)
class Seen:
    """Points xyz (P, 3) as scanned, and the pieces (P,) and the stations (P,) that they are of."""

    xyz: Floats
    piece: Ints
    station: Ints


def scan_with(
    rng: np.random.Generator, name: str, scanner: Scanner, surface: Surface, pieces: Pieces
) -> Seen:
    """What the scanner of that name in `wide.toml` gives of a surface."""
    if name == "photo":
        return scan_photo(rng, surface, pieces, scanner)
    if name == "round":
        return scan_round(surface)
    places = STATIONS[name](rng, scanner, surface.xyz)
    return scan_from(rng, places, scanner, surface)


def scan_round(surface: Surface) -> Seen:
    """Every surface evenly, without error."""
    station = np.zeros(len(surface.xyz), np.int64)
    return Seen(xyz=surface.xyz, piece=surface.piece, station=station)


def scan_photo(
    rng: np.random.Generator, surface: Surface, pieces: Pieces, scanner: Scanner
) -> Seen:
    """Photogrammetry: thin wood is missing in patches, the rest is blurred in blobs."""
    blob, blur = even(rng, scanner.blob), even(rng, scanner.blur)
    thin = even(rng, scanner.missing)
    radius = np.where(surface.piece >= 0, pieces.radius[surface.piece], 1.0)
    there = 1 / (1 + (thin / np.maximum(radius, 1e-4)) ** 3)
    seen = scan_round(surface.take(there > noise3(rng, surface.xyz, 3 * blob)))
    off = np.column_stack([noise3(rng, seen.xyz, blob) - 0.5 for _ in range(3)])
    return replace(seen, xyz=seen.xyz + 2 * blur * off)


def scan_from(
    rng: np.random.Generator, stations: Floats, scanner: Scanner, surface: Surface
) -> Seen:
    """The nearest surface in each pixel of each station (T, 3), with errors along the ray."""
    resolution = MILLI * even(rng, scanner.resolution)
    noise, flying = MILLI * even(rng, scanner.noise), even(rng, scanner.flying)
    rings = MILLI * even(rng, scanner.rings)
    xyz, piece, owner = [], [], []
    for number, station in enumerate(stations):
        near, far = seen_from(surface, station, resolution)
        ray = surface.xyz[near] - station
        if rings:
            kept = _on_rings(ray, rings)
            near, far, ray = near[kept], far[kept], ray[kept]
        distance = np.linalg.norm(ray, axis=1)
        behind = np.linalg.norm(surface.xyz[far] - station, axis=1) - distance
        flies = (behind > EDGE_M) & (rng.random(len(near)) < flying)
        error = noise * distance**2 * rng.normal(size=len(near))
        error += np.where(flies, behind * rng.random(len(near)), 0.0)
        xyz.append(station + ray * (1 + error / np.maximum(distance, 1e-9))[:, None])
        piece.append(surface.piece[near])
        owner.append(np.full(len(near), number))
    return Seen(xyz=np.concatenate(xyz), piece=np.concatenate(piece), station=np.concatenate(owner))


def _on_rings(ray: Floats, rings: float) -> Floats:
    """Which rays (V, 3) lie on the lines of a lidar, so many radians apart."""
    elevation = np.arctan2(ray[:, 2], np.hypot(ray[:, 0], ray[:, 1])) / rings
    return np.asarray(np.abs(elevation - np.rint(elevation)) < BEAM_SHARE / 2)


def _on_one_side(rng: np.random.Generator, scanner: Scanner, xyz: Floats) -> Floats:
    """Stations (T, 3) before the row, on the side of smaller Y, side by side."""
    count = whole(rng, scanner.stations)
    low, high = np.percentile(xyz[:, 0], [5, 95])
    x = rng.uniform(low, high) + APART_M * (np.arange(count) - (count - 1) / 2)
    return _standing(rng, scanner, x, np.median(xyz[:, 1]) - np.ones(count))


def _all_round(rng: np.random.Generator, scanner: Scanner, xyz: Floats) -> Floats:
    count = whole(rng, scanner.stations)
    turn = rng.uniform(0, 2 * math.pi) + 2 * math.pi * np.arange(count) / count
    middle = np.median(xyz[:, :2], axis=0)
    distance = rng.uniform(*scanner.distance, count)
    x, y = middle[0] + distance * np.cos(turn), middle[1] + distance * np.sin(turn)
    return np.column_stack([x, y, rng.uniform(*scanner.height, count)])


def _driving(rng: np.random.Generator, scanner: Scanner, xyz: Floats) -> Floats:
    """Stations along a straight way before the row."""
    count = whole(rng, scanner.stations)
    low, high = xyz[:, 0].min() - 0.5, xyz[:, 0].max() + 0.5
    return _standing(rng, scanner, np.linspace(low, high, count), np.median(xyz[:, 1]) - 1.0)


def _standing(
    rng: np.random.Generator, scanner: Scanner, x: Floats, depth: Floats | float
) -> Floats:
    """Places (T, 3) at x (T,), one distance and height for all."""
    y = np.broadcast_to(depth, x.shape) + 1.0 - even(rng, scanner.distance)
    return np.column_stack([x, y, np.full(len(x), even(rng, scanner.height))])


STATIONS = {
    "rgbd": _on_one_side,
    "side": _on_one_side,
    "laser": _all_round,
    "lines": _driving,
}
"""Where the stations of each scanner stand."""
