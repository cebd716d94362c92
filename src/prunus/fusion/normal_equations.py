"""Register views on each other: partners of axis samples, and the joint normal equations.

S samples lie on the axes of branches as V views see them. Two samples of one branch, seen in two
views, may slide along it, so only what is across it counts, each direction by how well it is known.
"""

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.geometry.neighbours import bucket_of, build_grid
from prunus.model.arrays import Floats, Ints


@kernel
def partners(xyz: Floats, axis: Floats, view: Ints, V: int, radius: float, alike: float) -> Ints:
    """The nearest sample of each other view to each sample: rows (S, V), -1 = none.

    None is farther than `radius` metres or has an axis whose cosine with the own is under `alike`.
    """
    S = len(xyz)
    cell, start, order = build_grid(xyz, radius)
    buckets = len(start) - 1
    chosen = np.full((S, V), -1)
    nearest = np.empty(V)
    for s in range(S):
        nearest[:] = radius * radius
        x, y, z = cell[s]
        for near in range(27):
            cx, cy, cz = x + near // 9 - 1, y + near // 3 % 3 - 1, z + near % 3 - 1
            bucket = bucket_of(cx, cy, cz, buckets)
            for slot in range(start[bucket], start[bucket + 1]):
                q = order[slot]
                if view[q] == view[s] or cell[q, 0] != cx or cell[q, 1] != cy or cell[q, 2] != cz:
                    continue
                cosine, away = 0.0, 0.0
                for a in range(3):
                    cosine += axis[q, a] * axis[s, a]
                    away += (xyz[q, a] - xyz[s, a]) ** 2
                if away < nearest[view[q]] and abs(cosine) >= alike:
                    nearest[view[q]] = away
                    chosen[s, view[q]] = q
    return chosen


@kernel
def apart(
    xyz: Floats, axis: Floats, doubt: Floats, s: int, q: int, across: Floats
) -> tuple[Floats, Floats]:
    """How far sample s is from the line of q (2,), and the certainty of that (2, 2).

    `across` (2, 3) is filled with two directions across the branch; `doubt` (S, 3, 3) are the
    covariances of the samples.
    """
    along = axis[s] + axis[q] * np.sign((axis[s] * axis[q]).sum())
    along = along / np.sqrt((along * along).sum())
    least = 0
    for a in range(1, 3):
        if abs(along[a]) < abs(along[least]):
            least = a
    across[0] = -along * along[least]
    across[0, least] += 1.0
    across[0] /= np.sqrt((across[0] * across[0]).sum())
    across[1] = np.cross(along, across[0])
    both = across @ (doubt[s] + doubt[q]) @ across.T
    determinant = both[0, 0] * both[1, 1] - both[0, 1] * both[1, 0]
    certain = np.empty((2, 2))
    certain[0, 0], certain[1, 1] = both[1, 1] / determinant, both[0, 0] / determinant
    certain[0, 1] = certain[1, 0] = -both[0, 1] / determinant
    return across @ (xyz[s] - xyz[q]), certain


@kernel
def normal_equations(
    xyz: Floats, axis: Floats, doubt: Floats, view: Ints, partner: Ints, scale: float
) -> tuple[Floats, Floats]:
    """Matrix (6V, 6V) and right side (6V,) of the Gauss-Newton step of all views together.

    A step of a view turns about the origin by its first three (radians), then moves by its last.
    Residuals e count (1 + |e|^2 / scale^2)^-2 (Geman and McClure), |e| in standard deviations.
    """
    V = partner.shape[1]
    matrix, right = np.zeros((6 * V, 6 * V)), np.zeros(6 * V)
    across, jacobian = np.empty((2, 3)), np.empty((2, 12))
    for s in range(len(xyz)):
        for other in range(V):
            q = partner[s, other]
            if q < 0:
                continue
            off, certain = apart(xyz, axis, doubt, s, q, across)
            square = (off * (certain @ off)).sum()
            weighted = certain / (1.0 + square / (scale * scale)) ** 2
            for row in range(2):
                jacobian[row, :3] = np.cross(xyz[s], across[row])
                jacobian[row, 3:6] = across[row]
                jacobian[row, 6:9] = -np.cross(xyz[q], across[row])
                jacobian[row, 9:] = -across[row]
            block, pull = jacobian.T @ weighted @ jacobian, jacobian.T @ (weighted @ off)
            for i in range(12):
                row = 6 * (view[s] if i < 6 else other) + i % 6
                right[row] -= pull[i]
                for j in range(12):
                    matrix[row, 6 * (view[s] if j < 6 else other) + j % 6] += block[i, j]
    return matrix, right


@kernel
def residuals(xyz: Floats, axis: Floats, doubt: Floats, partner: Ints) -> tuple[Floats, Floats]:
    """How far each sample is from the line of each partner (S, V): metres, standard deviations.

    NaN where there is no partner.
    """
    S, V = partner.shape
    metres, deviations = np.full((S, V), np.nan), np.full((S, V), np.nan)
    across = np.empty((2, 3))
    for s in range(S):
        for other in range(V):
            if partner[s, other] < 0:
                continue
            off, certain = apart(xyz, axis, doubt, s, partner[s, other], across)
            metres[s, other] = np.sqrt((off * off).sum())
            deviations[s, other] = np.sqrt((off * (certain @ off)).sum())
    return metres, deviations
