"""Small trees drawn as text, one character a node, 10 cm apart, seen from the front.

`o` is the base; t, s, l, b end an edge of trunk, support, leader, side branch. A node hangs on the
neighbour from which it is reached first, coming from the base; a diagonal step counts 2.5 steps.
"""

from __future__ import annotations

import heapq
import itertools

import numpy as np

from prunus.model import Label, Skeleton

STEP = 0.1
LABELS = {
    "o": Label.TRUNK,
    "t": Label.TRUNK,
    "s": Label.SUPPORT,
    "l": Label.LEADER,
    "b": Label.SIDE_BRANCH,
}
AROUND = [(0, 1), (1, 0), (-1, 0), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]

TREE = """
l   l  l
l   lb l
l   l  l
ssstssss
   t
   o
"""
"""A whole tree: two supports, three leaders, one side branch."""


def tree(picture: str = TREE) -> Skeleton:
    """The drawn skeleton, rows parents first."""
    letters = cells(picture)
    base = next(cell for cell, letter in letters.items() if letter == "o")
    order: list[tuple[int, int]] = []
    parent: list[int] = []
    waiting = [(0.0, 0, base, -1)]
    for count in itertools.count():
        if not waiting:
            break
        far, _, (x, z), above = heapq.heappop(waiting)
        if (x, z) in order:
            continue
        order.append((x, z))
        parent.append(above)
        for dx, dz in AROUND:
            if (x + dx, z + dz) in letters:
                step = 2.5 if dx and dz else 1.0
                item = (far + step, len(AROUND) * count, (x + dx, z + dz), len(order) - 1)
                heapq.heappush(waiting, item)
    assert len(order) == len(letters), "the drawing is in pieces"
    xyz = np.array([(x * STEP, 0.0, z * STEP) for x, z in order])
    labels = [LABELS[letters[cell]] for cell in order]
    labels[0] = labels[1] if len(labels) > 1 else Label.TRUNK
    return Skeleton.build(xyz, parent, labels)


def cells(picture: str) -> dict[tuple[int, int], str]:
    """The letter of each drawn cell (x, z), the lowest line at z = 0."""
    lines = picture.strip("\n").splitlines()
    return {
        (x, len(lines) - 1 - line): letter
        for line, text in enumerate(lines)
        for x, letter in enumerate(text)
        if letter != " "
    }


def clouds(seed: int, count: int) -> np.ndarray:
    """Points on the model's grid, some of them in one place."""
    rng = np.random.default_rng(seed)
    points = np.rint(rng.uniform(-1, 1, (count, 3)) * 2**10) / 2**10
    points[count // 2 :: 3] = points[0]
    return points
