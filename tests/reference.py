"""The slow, obvious twins of the kernels, for the tests: plain loops, sets and sorted lists.

A skeleton is here what the paper says it is, a set of (edge, label) pairs, an edge being a pair of
nodes (tail, head).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from prunus.model.arrays import Bools, Floats, Ints

Edge = tuple[int, int]
Pairs = frozenset[tuple[Edge, int]]
Path = tuple[Edge, ...]


def within(points: Floats, centers: Floats, radius: float) -> list[list[int]]:
    """The points within the radius of each center."""
    return [
        [p for p, point in enumerate(points) if ((point - center) ** 2).sum() <= radius * radius]
        for center in centers
    ]


def away_from(points: Floats, line: Floats) -> list[float]:
    """The distance of each point from the nearest of the stretches between nodes."""
    pieces = list(pairwise(line)) or [(line[0], line[0])]
    return [min(_from_stretch(point, *piece) for piece in pieces) for point in points]


def _from_stretch(point: Floats, start: Floats, end: Floats) -> float:
    step = end - start
    square = float(step @ step)
    share = min(max(float((point - start) @ step) / square, 0.0), 1.0) if square else 0.0
    return float(np.linalg.norm(start + share * step - point))


def cover(points: Floats, order: Iterable[int], radius: float) -> tuple[Floats, Ints]:
    """Means and sizes of balls around uncovered points, met in order."""
    covered: set[int] = set()
    means, sizes = [], []
    for p in order:
        if p not in covered:
            (ball,) = within(points, points[p : p + 1], radius)
            covered |= set(ball)
            means.append(points[ball].mean(axis=0))
            sizes.append(len(ball))
    return np.array(means), np.array(sizes)


def spanning_forest(nodes: int, edges: Ints, order: Iterable[int]) -> Bools:
    """Kruskal with sets of nodes."""
    sets = [{n} for n in range(nodes)]
    taken = np.zeros(len(edges), np.bool_)
    for e in order:
        i, j = edges[e]
        first = next(s for s in sets if i in s)
        second = next(s for s in sets if j in s)
        if first is not second:
            taken[e] = True
            sets.remove(second)
            first |= second
    return taken


def edge_image(points: Floats, ends: Floats, radius: float, shape: tuple[int, int]) -> Floats:
    """The image of an edge between two `ends` (2, 3), as the paper says; up to a flip of y."""
    near = (np.linalg.norm(points[:, None] - ends, axis=2) <= radius).any(axis=1)
    chosen = points[near]
    x = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    z = np.linalg.svd(chosen - chosen.mean(axis=0))[2][2]
    z = z - (z @ x) * x
    z = z / np.linalg.norm(z)
    local = (chosen - ends.mean(axis=0)) @ np.column_stack([np.cross(z, x), x])
    window = [(-radius, radius), (-2 * radius, 2 * radius)]
    image = np.histogram2d(local[:, 0], local[:, 1], shape, window)[0]
    return np.asarray(image / max(image.max(), 1))


def average_ranks(values: list[float]) -> list[float]:
    """Rank: the position in the sorted list, ties averaged, divided by how many there are."""
    ordered = sorted(values)
    positions = [[i + 1 for i, other in enumerate(ordered) if other == value] for value in values]
    return [sum(found) / len(found) / len(values) for found in positions]


@dataclass(frozen=True)
class Orchard:
    """A graph to search, with every rule as a plain function.

    edge_score(e), grow_penalty(e, l), turn_penalty(e_s, e_p), cost(e) = Len (1 - Conf), and
    is_legal(S). Labels count from 0 (trunk) to 2 (leader).
    """

    base: int
    edges: frozenset[Edge]
    edge_score: Callable[[Edge], float]
    grow_penalty: Callable[[Edge, int], float]
    turn_penalty: Callable[[Edge, Edge], float]
    cost: Callable[[Edge], float]
    is_legal: Callable[[Pairs], bool]

    def score(self, skeleton: Pairs) -> float:
        """SkelScore."""
        into = {edge[1]: (edge, label) for edge, label in skeleton}
        total = 0.0
        for edge, label in skeleton:
            total += self.edge_score(edge) - self.grow_penalty(edge, label)
            before = into.get(edge[0])
            if before is not None and before[1] == label:
                total -= self.turn_penalty(edge, before[0])
        return total

    def paths(self, tip: int) -> dict[Edge, Path]:
        """The path prior of every edge from which the tip is in reach, the edge itself first.

        Settles the cheapest open edge, as Dijkstra; a path never visits a node twice.
        """
        open_paths: dict[Edge, tuple[float, Path]] = {
            e: (0.0, (e,)) for e in self.edges if e[1] == tip and e[0] != tip
        }
        settled: dict[Edge, Path] = {}
        while open_paths:
            edge = min(open_paths, key=lambda e: (open_paths[e][0], e))
            total, path = open_paths.pop(edge)
            settled[edge] = path
            if edge[0] == self.base:
                continue
            visited = {node for step in path for node in step}
            for before in self.edges:
                if before[1] != edge[0] or before in settled or before[0] in visited:
                    continue
                longer = total + self.cost(edge) + self.turn_penalty(edge, before)
                if longer < open_paths.get(before, (math.inf, ()))[0]:
                    open_paths[before] = (longer, (before, *path))
        return settled

    def eligible(self, skeleton: Pairs, paths: dict[Edge, Path]) -> set[tuple[Edge, int]]:
        """Eligible(S, n_tip)."""
        nodes = {self.base} | {edge[1] for edge, _ in skeleton}
        found = set()
        for edge, path in paths.items():
            ahead = {step[1] for step in path}
            if edge[0] in nodes and not ahead & nodes:
                for label in range(3):
                    if self.is_legal(skeleton | {(edge, label)}):
                        found.add((edge, label))
        return found

    def potential(self, skeleton: Pairs, edge: Edge, label: int, path: Path) -> float:
        """Potential[S, n_tip](e, l): each edge once, the 2 - Order(l) largest turns dropped."""
        turns = [self.turn_penalty(after, before) for before, after in pairwise(path)]
        kept = sorted(turns)[: max(0, len(turns) - (2 - label))]
        beyond = sum(self.edge_score(step) for step in path[1:])
        return self.score(skeleton | {(edge, label)}) + beyond - sum(kept)

    def weights(self, population: list[Pairs], tips: list[int | None]) -> dict[Pairs, float]:
        """The weight of every next-generation skeleton; tips[k] is what member k drew, if any."""
        score_rank = average_ranks([round(self.score(skeleton), 9) for skeleton in population])
        priors = {tip: self.paths(tip) for tip in tips if tip is not None}
        weight: dict[Pairs, float] = {}
        for k, skeleton in enumerate(population):
            tip = tips[k]
            if tip is None:
                continue
            paths = priors[tip]
            pairs = sorted(self.eligible(skeleton, paths))
            potentials = [self.potential(skeleton, e, label, paths[e]) for e, label in pairs]
            ranks = average_ranks([round(value, 9) for value in potentials])
            for pair, rank in zip(pairs, ranks, strict=True):
                grown = skeleton | {pair}
                weight[grown] = weight.get(grown, 0.0) + score_rank[k] * rank
        return weight

    def best(self) -> tuple[Pairs, float]:
        """The best of all legal skeletons, by trying every one. For very small graphs."""
        empty: Pairs = frozenset()
        known, waiting = {empty}, [empty]
        best, best_score = empty, 0.0
        while waiting:
            skeleton = waiting.pop()
            total = self.score(skeleton)
            if total > best_score:
                best, best_score = skeleton, total
            nodes = {self.base} | {edge[1] for edge, _ in skeleton}
            for edge in self.edges:
                if edge[0] not in nodes or edge[1] in nodes:
                    continue
                for label in range(3):
                    grown = skeleton | {(edge, label)}
                    if grown not in known and self.is_legal(grown):
                        known.add(grown)
                        waiting.append(grown)
        return best, best_score


def nearest_on_lines(
    points: Floats, station: Floats, line: Ints, reach: float
) -> list[tuple[int, float, float]]:
    """For each point the station before it, the share of the way to the next, the distance."""
    found = []
    for point in points:
        away = np.linalg.norm(station - point, axis=1)
        best = int(away.argmin())
        places = [(math.inf, -1, 0.0)]
        for s in (best - 1, best):
            if away[best] <= reach and s >= 0 and s + 1 < len(line) and line[s] == line[s + 1]:
                step = station[s + 1] - station[s]
                share = min(max(float((point - station[s]) @ step) / float(step @ step), 0.0), 1.0)
                places.append((float(np.linalg.norm(station[s] + share * step - point)), s, share))
        distance, before, share = min(places, key=lambda place: place[0])
        found.append((before, share, distance))
    return found


def feet(
    lines: list[Floats],
    parent: Ints,
    inside: list[Bools],
    home: Floats,
    usual: Floats,
    err: Floats,
    ahead: int,
    slide: int,
) -> list[int]:
    """For each line the station of its parent, counted along it, from which it leaves; or -1."""
    found = []
    for b, (line, above, within_it) in enumerate(zip(lines, parent, inside, strict=True)):
        if above < 0:
            found.append(-1)
            continue
        free = [s for s in range(len(line) - 2) if not within_it[s]]
        out = min([*free, len(line) - 2])
        toward = line[min(out + ahead, len(line) - 1)] - line[out]
        toward = toward / np.linalg.norm(toward)
        own = lines[above]
        now = int(np.linalg.norm(own - home[b], axis=1).argmin())
        costs = {}
        for s in range(max(1, now - slide), min(len(own) - 1, now + slide + 1)):
            step, on = own[s] - line[out], own[s + 1] - own[s - 1]
            beside = np.linalg.norm(step - min(float(step @ toward), 0.0) * toward)
            cosine = -step @ on / np.linalg.norm(step) / np.linalg.norm(on)
            turn = (np.arccos(np.clip(cosine, -1, 1)) - usual[b, 0]) / usual[b, 1]
            moved = np.linalg.norm(own[s] - home[b])
            costs[s] = (beside / err[b, 0]) ** 2 + (moved / err[b, 1]) ** 2 + turn**2
        found.append(min(costs, key=lambda s: costs[s]) if costs else len(own) - 1)
    return found
