"""Depth images: round wood and ground as a camera sees them, and what stereo matching does to them.

A camera looks along its z axis, x to the right, y down; a pixel (row, column) looks along
((column - W / 2) / focal, (row - H / 2) / focal, 1). Depth is along z, 0 where nothing is seen.
"""

import math

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.model.arrays import Floats, Ints

NOTHING = -1
"""In an owner image: no surface."""
GROUND = -2
"""In an owner image: the ground."""


@kernel
def draw_wood(
    start: Floats, end: Floats, radius: Floats, focal: float, depth: Floats, owner: Ints
) -> None:
    """Draw round pieces between start and end (S, 3), radius (S,), in the camera's frame.

    `depth` and `owner` (H, W) keep the nearest surface and its piece. A piece thinner than a
    pixel covers one.
    """
    H, W = depth.shape
    for s in range(len(start)):
        az, bz = start[s, 2], end[s, 2]
        if az < 0.15 or bz < 0.15:
            continue
        ax, ay = start[s, 0] / az * focal + W / 2, start[s, 1] / az * focal + H / 2
        bx, by = end[s, 0] / bz * focal + W / 2, end[s, 1] / bz * focal + H / 2
        wide = max(radius[s] * focal / min(az, bz), 0.5)
        left, right = math.floor(min(ax, bx) - wide), math.ceil(max(ax, bx) + wide)
        top, bottom = math.floor(min(ay, by) - wide), math.ceil(max(ay, by) + wide)
        dx, dy = bx - ax, by - ay
        square = dx * dx + dy * dy
        for row in range(max(top, 0), min(bottom + 1, H)):
            for column in range(max(left, 0), min(right + 1, W)):
                px, py = column + 0.5 - ax, row + 0.5 - ay
                share = 0.0 if square < 1e-9 else (px * dx + py * dy) / square
                share = min(max(share, 0.0), 1.0)
                ox, oy = px - share * dx, py - share * dy
                off = ox * ox + oy * oy
                if off > wide * wide:
                    continue
                bulge = radius[s] * math.sqrt(max(0.0, 1.0 - off / (wide * wide)))
                z = az + share * (bz - az) - bulge
                if depth[row, column] == 0.0 or z < depth[row, column]:
                    depth[row, column] = z
                    owner[row, column] = s


@kernel
def draw_ground(
    rotation: Floats,
    centre: Floats,
    focal: float,
    heights: Floats,
    cell: float,
    depth: Floats,
    owner: Ints,
) -> None:
    """Draw the ground into `depth` and `owner` (H, W), where no wood is nearer.

    The camera stands at `centre` (3,) with axes in the columns of `rotation` (3, 3). `heights`
    (A, B) are those of a grid of square cells, repeated without end.
    """
    H, W = depth.shape
    A, B = heights.shape
    for row in range(H):
        for column in range(W):
            x, y = (column + 0.5 - W / 2) / focal, (row + 0.5 - H / 2) / focal
            down = rotation[2, 0] * x + rotation[2, 1] * y + rotation[2, 2]
            if down > -0.05:
                continue
            east = rotation[0, 0] * x + rotation[0, 1] * y + rotation[0, 2]
            north = rotation[1, 0] * x + rotation[1, 1] * y + rotation[1, 2]
            z, level = 0.0, 0.0
            for _ in range(3):
                z = (level - centre[2]) / down
                a = math.floor((centre[0] + z * east) / cell) % A
                b = math.floor((centre[1] + z * north) / cell) % B
                level = heights[a, b]
            if depth[row, column] == 0.0 or z < depth[row, column]:
                depth[row, column] = z
                owner[row, column] = GROUND


@kernel
def fatten(depth: Floats, owner: Ints, reach: Ints) -> tuple[Floats, Ints]:
    """Depth and owner as block matching gives them: near surfaces spill over their edges.

    Each pixel takes the nearest surface within `reach` (H, W) pixels.
    """
    H, W = depth.shape
    spilled, whose = depth.copy(), owner.copy()
    for row in range(H):
        for column in range(W):
            far = reach[row, column]
            nearest = depth[row, column]
            for r in range(max(row - far, 0), min(row + far + 1, H)):
                for c in range(max(column - far, 0), min(column + far + 1, W)):
                    z = depth[r, c]
                    nearer = z > 0.0 and (nearest == 0.0 or z < nearest)
                    if nearer and (r - row) ** 2 + (c - column) ** 2 <= far * far:
                        nearest = z
                        spilled[row, column] = z
                        whose[row, column] = owner[r, c]
    return spilled, whose


@kernel
def fly(depth: Floats, jump: float, chance: Floats, share: Floats) -> None:
    """Let pixels at edges fly: between the near surface and what lies behind it, in disparity.

    An edge is where a neighbour is empty or `jump` metres deeper; `chance` (H, W) is the
    probability of each pixel times its draw, under 1 where it flies; `share` (H, W) how far.
    """
    H, W = depth.shape
    before = depth.copy()
    for row in range(1, H - 1):
        for column in range(1, W - 1):
            z = before[row, column]
            if z == 0.0 or chance[row, column] >= 1.0:
                continue
            behind = z
            for step in range(4):
                r = row + (step == 0) - (step == 1)
                c = column + (step == 2) - (step == 3)
                other = before[r, c] if before[r, c] > 0.0 else 1.25 * z
                behind = max(behind, other)
            if behind > z + jump:
                mixed = (1.0 - share[row, column]) / z + share[row, column] / behind
                depth[row, column] = 1.0 / mixed


@kernel
def points_of(depth: Floats, focal: float) -> tuple[Floats, Ints, Ints]:
    """The points (Q, 3) of a depth image in the camera's frame, and their rows and columns (Q,)."""
    H, W = depth.shape
    count = 0
    for row in range(H):
        for column in range(W):
            count += depth[row, column] > 0.0
    points = np.empty((count, 3))
    rows, columns = np.empty(count, np.int64), np.empty(count, np.int64)
    q = 0
    for row in range(H):
        for column in range(W):
            z = depth[row, column]
            if z > 0.0:
                points[q, 0] = (column + 0.5 - W / 2) / focal * z
                points[q, 1] = (row + 0.5 - H / 2) / focal * z
                points[q, 2] = z
                rows[q], columns[q] = row, column
                q += 1
    return points, rows, columns
