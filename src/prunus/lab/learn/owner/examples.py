"""What the network learns from that tells whose wood is: threads of simulated rows.

Of each node the tree is known; feet, ways and tokens are found anew each time that it is shown.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from scipy.sparse.csgraph import dijkstra

from prunus.field.network import see_field
from prunus.field.votes import Threads, gather_votes
from prunus.field.voxels import voxels_of
from prunus.field.wires import without_wires
from prunus.growth.belonging import MOST_TOKENS
from prunus.growth.feet import find_feet
from prunus.growth.graph import join_threads
from prunus.growth.tokens import Tokens
from prunus.io.arrays import read_arrays, write_arrays
from prunus.lab.learn.field.examples import SCALE, motion
from prunus.lab.simulate.scan import Scan
from prunus.model import Bools, Floats, Ints

POINTS = 100_000  # of a scan that are looked at, as by default
NARROWED, NARROWER = 0.5, 0.3  # share of scenes cut at both ends, each by up to that share
CUT_BELOW, BELOW = 0.15, 0.2  # share of scenes without their lowest wood, and how much of it
CUT_OUT = 0.2  # share of scenes out of which a tree was cut
LOST = 0.1  # up to that share of the nodes is taken out,
HOLES, HOLE_M = 4, (0.03, 0.15)  # and up to so many balls of them
VOTED = 0.6  # votes are multiplied by that at least, so that tokens are others
AT_FOOT_M = 0.06  # a foot stands on the tree of most nodes so near
MOST_FEET = 3  # asked of one scene
_OF_THREADS = ("xyz", "role", "radius", "toward_foot", "votes")


@dataclass(frozen=True, eq=False, kw_only=True)
class OwnerExample:
    """The threads (N) of a scan, and the tree of each node (N,), -1 where it is of none."""

    xyz: Floats
    role: Floats
    radius: Floats
    toward_foot: Floats
    votes: Floats
    tree: Ints

    @classmethod
    def of(cls, scan: Scan, rng: np.random.Generator) -> OwnerExample:
        """The example of a simulated scan, as the shipped point field sees it."""
        count = len(scan.xyz)
        drawn = np.sort(rng.choice(count, min(count, POINTS), replace=False))
        voxels = voxels_of(scan.xyz[drawn])
        threads = gather_votes(without_wires(see_field(voxels), rng))
        node, tree = threads.of_voxel[voxels.of_point], scan.tree[drawn]
        told = (node >= 0) & (tree >= 0)
        counts = np.zeros((len(threads), len(scan.row.trees)), np.int64)
        np.add.at(counts, (node[told], tree[told]), 1)
        own = np.where(counts.any(axis=1), counts.argmax(axis=1), -1)
        held = {name: getattr(threads, name) for name in _OF_THREADS}
        return cls(**held, tree=own)

    @property
    def lacks(self) -> str | None:
        """Why nothing can be learned from it: nobody asks whose wood is of a single tree."""
        feet = len(find_feet(join_threads(self.threads))) if len(self.xyz) else 0
        return None if feet > 1 else f"{feet} feet"

    @property
    def threads(self) -> Threads:
        """Its threads, as far as they are known."""
        count = len(self.xyz)
        held = {name: np.asarray(getattr(self, name), np.float64) for name in _OF_THREADS}
        return Threads(**held, scatter=np.zeros(count), beyond=np.zeros((count, 2)),
                       of_voxel=np.arange(count))  # fmt: skip

    def take(self, rows: Ints | Bools) -> OwnerExample:
        """The example of these nodes only."""
        return OwnerExample(**{one.name: getattr(self, one.name)[rows] for one in fields(self)})

    def write(self, path: Path) -> None:
        """Keep it, in single precision."""
        held = {name: getattr(self, name).astype(np.float32) for name in _OF_THREADS}
        write_arrays(path, held | {"tree": self.tree}, "prunus owner example")

    @classmethod
    def read(cls, path: Path) -> OwnerExample:
        """Read what `write` wrote."""
        return cls(**read_arrays(path)[0])

    def shown(self, rng: np.random.Generator) -> OwnerExample:
        """Another view of it: less of the row, holes, turned, mirrored, scaled, other votes."""
        seen = self.take(_in_view(self, rng))
        turn, scale = motion(rng), rng.uniform(*SCALE)
        return OwnerExample(
            xyz=scale * seen.xyz @ turn.T,
            role=seen.role,
            radius=scale * seen.radius,
            toward_foot=seen.toward_foot @ turn.T,
            votes=seen.votes * rng.uniform(VOTED, 1, len(seen.votes)),
            tree=seen.tree,
        )


def _in_view(example: OwnerExample, rng: np.random.Generator) -> Bools:
    """Which nodes (N,) are shown."""
    xyz = example.xyz
    left, right = xyz[:, 0].min(), xyz[:, 0].max()
    seen = rng.random(len(xyz)) > rng.uniform(0, LOST)
    if rng.random() < NARROWED:
        room = NARROWER * (right - left) * rng.random(2)
        seen &= (xyz[:, 0] >= left + room[0]) & (xyz[:, 0] <= right - room[1])
    if rng.random() < CUT_BELOW:
        seen &= xyz[:, 2] > np.quantile(xyz[:, 2], BELOW * rng.random())
    if rng.random() < CUT_OUT:
        seen &= example.tree != rng.integers(example.tree.max(initial=0) + 1)
    for _ in range(rng.integers(HOLES + 1)):
        away = np.linalg.norm(xyz - xyz[rng.integers(len(xyz))], axis=1)
        seen &= away > rng.uniform(*HOLE_M)
    return np.asarray(seen)


@dataclass(frozen=True, eq=False, kw_only=True)
class OwnerLesson:
    """Some feet of a scene: its tokens, which of them are asked about, and whose they are.

    feet (F,), rows of those of the tokens; tree (F,), on which each stands, -1 = on none; whose
    (T, trees + 1), the share of the nodes of a token that are of each tree, then of none known;
    nodes (T,), how many a token has; by_cost (F, T), the share of them that costs each foot least.
    """

    tokens: Tokens
    feet: Ints
    tree: Ints
    whose: Floats
    nodes: Ints
    by_cost: Floats

    def rows(self, foot: int) -> Ints:
        """The tokens that are asked about for a foot."""
        return self.tokens.near(foot, MOST_TOKENS)


def owner_lesson(
    example: OwnerExample, rng: np.random.Generator | None = None
) -> OwnerLesson | None:
    """The lesson of an example, None where a single foot is in view.

    With `rng`, of some feet that stand together.
    """
    if len(example.xyz) == 0:
        return None
    threads = example.threads
    graph = join_threads(threads)
    feet = find_feet(graph)
    if len(feet) < 2:
        return None
    cost = dijkstra(graph.belonging, indices=feet)
    tokens = Tokens.of(threads, feet, cost)
    chosen = np.arange(len(feet))
    if rng is not None and len(feet) > MOST_FEET:
        away = np.linalg.norm(tokens.feet - tokens.feet[rng.integers(len(feet))], axis=1)
        chosen = np.argsort(away, kind="stable")[:MOST_FEET]
    whose = np.zeros((len(tokens.xyz), example.tree.max(initial=0) + 2))
    np.add.at(whose, (tokens.of_node, example.tree), 1)
    nodes = whose.sum(axis=1)
    tree = [_tree_at(threads, int(feet[row]), example.tree) for row in chosen]
    least = cost.argmin(axis=0)
    by_cost = [np.bincount(tokens.of_node, least == foot) / nodes for foot in chosen]
    return OwnerLesson(
        tokens=tokens, feet=chosen, tree=np.array(tree), whose=whose / nodes[:, None],
        nodes=nodes.astype(np.int64), by_cost=np.array(by_cost),
    )  # fmt: skip


def _tree_at(threads: Threads, foot: int, tree: Ints) -> int:
    """The tree of most nodes around a foot, -1 where none is known."""
    near = tree[threads.tree.query_ball_point(threads.xyz[foot], AT_FOOT_M)]
    near = near[near >= 0]
    return int(np.bincount(near).argmax()) if len(near) else -1
