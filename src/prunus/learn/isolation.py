"""Learning what of a scan is the tree that is meant (beyond the paper, which does it by hand).

A network that passes messages between superpoints: it sees the scan from the base of one tree, and
tells of each superpoint what it is to that tree (`model.Kind`). Every tree of a simulated row whose
trunk the scan holds is asked for in turn, and its neighbours are what they are to it.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from prunus.geometry.near import nearest, within
from prunus.io.scans import ScannedTree, read_scan
from prunus.learn.examples import VIEWS, drawn
from prunus.learn.start import go_on_from
from prunus.learn.train import exported
from prunus.measure import branches
from prunus.model import Floats, Ints, Kind, Label, PointCloud, Skeleton
from prunus.params import Parameters
from prunus.sensing.isolate import NODE_REACH, judged_graph
from prunus.sensing.surroundings import LINK_FEATURES, NODE_FEATURES, Pieces, Surroundings
from prunus.workers import in_order

GRAPHS = 2
"""Draws of points from each scan."""
SHARES = (0.7, 0.2, 0.1)
"""How often the further draws are of each of `VIEWS`; the first is of all that was scanned."""
SEEN = 0.03
"""A trunk is seen where a point of it is within so many metres."""
FEWEST = 1000
"""Trees of fewer points are not asked for."""
THINGS = 4
"""Kinds that are no tree: ground, post, wire, stray."""
BATCH = 2
EPOCHS = 16
RATE = 3e-3
GOING_ON = 1e-3
"""The rate of a network that goes on from another, in `MORE` epochs."""
MORE = 5


@dataclass(frozen=True, eq=False)
class RowExample:
    """The superpoints of a scan, and their points (N, T + THINGS) of each tree and of things.

    base (T, 3) where the scan holds the trunk of each tree, NaN where it holds none; behind (T,):
    whether it stands in the arm behind.
    """

    pieces: Pieces
    counts: Floats
    base: Floats
    behind: Ints

    @property
    def asked(self) -> list[int]:
        """The trees that can be asked for."""
        enough = self.counts[:, : len(self.base)].sum(axis=0) >= FEWEST
        return np.flatnonzero(enough & np.isfinite(self.base[:, 0])).tolist()

    def kinds(self, tree: int) -> Floats:
        """How many points (N, kinds) are what to one of the trees."""
        found = np.zeros((len(self.counts), len(Kind)))
        for other in range(len(self.base)):
            same_arm = self.behind[other] == self.behind[tree]
            kind = Kind.NEIGHBOUR if same_arm else Kind.BEHIND
            found[:, Kind.TARGET if other == tree else kind] += self.counts[:, other]
        found[:, Kind.GROUND :] = self.counts[:, len(self.base) :]
        return found


def row_examples(folders: list[Path], seed: int, jobs: int) -> Iterator[list[RowExample]]:
    """The examples of each scan, in order."""
    yield from in_order(partial(row_examples_in, seed=seed), folders, jobs)


def row_examples_in(folder: Path, seed: int) -> list[RowExample]:
    """The examples of one scan: a function of the scan and the seed."""
    scan = read_scan(folder)
    rng = np.random.default_rng([seed, *os.fsencode(folder.name)])
    kinds = [VIEWS[k] for k in (0, *rng.choice(len(VIEWS), GRAPHS - 1, p=SHARES))]
    return [row_example(scan, seen, rng) for seen in kinds]


def row_example(scan: ScannedTree, kinds: tuple[Kind, ...], rng: np.random.Generator) -> RowExample:
    """The superpoints of what a scan holds of some kinds."""
    held = np.isin(scan.kind, kinds)
    cloud = PointCloud.from_xyz(scan.xyz[held])
    pieces = Pieces.of(judged_graph(drawn(cloud, rng), Parameters.learned(), rng))
    to_house = cloud.to_input.inverse()
    owner = nearest(cloud.xyz, pieces.xyz, NODE_REACH)
    trees = len(scan.trees)
    whose = np.where(scan.tree >= 0, scan.tree, trees + scan.kind - Kind.GROUND)[held]
    counts = np.zeros((len(pieces.xyz), trees + THINGS))
    np.add.at(counts, (owner[owner >= 0], whose[owner >= 0]), 1)
    bases = [lowest_seen(scan, number) for number in range(trees)]
    behind = [int((scan.kind[scan.tree == number] == Kind.BEHIND).any()) for number in range(trees)]
    return RowExample(pieces, counts, to_house.apply(np.array(bases)), np.array(behind))


def lowest_seen(scan: ScannedTree, number: int) -> Floats:
    """The lowest point (3,) of a tree's trunk that the scan holds; NaN where it holds none."""
    tree: Skeleton = scan.trees[number]
    trunk = branches(tree)[0].rows
    own = scan.xyz[(scan.tree == number) & (scan.branch == 0)]
    start, _ = within(own, tree.xyz[trunk], SEEN)
    seen = trunk[np.diff(start) > 0]
    alone = len(seen) == 0 or tree.label[trunk[-1]] != Label.TRUNK
    return np.full(3, np.nan) if alone else tree.xyz[seen[0]]


class IsolationNet(nn.Module):
    """Each superpoint hears from those that its surest edges lead to, and from the whole scan."""

    ROUNDS = 6
    D = 48
    HEARD = 32
    ALL = 16

    def __init__(self) -> None:
        super().__init__()
        D, C, A = self.D, self.HEARD, self.ALL
        self.scale = nn.BatchNorm1d(NODE_FEATURES)
        self.node = nn.Sequential(nn.Linear(NODE_FEATURES, D), nn.ReLU(), nn.Linear(D, D))
        self.link = nn.Sequential(nn.Linear(LINK_FEATURES, C), nn.ReLU(), nn.Linear(C, C))
        self.say = nn.ModuleList(nn.Linear(D, C) for _ in range(self.ROUNDS))
        self.tell = nn.ModuleList(nn.Linear(D, 2 * A) for _ in range(self.ROUNDS))
        self.hear = nn.ModuleList(
            nn.Sequential(nn.Linear(D + 2 * C + A, D), nn.ReLU(), nn.Linear(D, D))
            for _ in range(self.ROUNDS)
        )
        self.norm = nn.ModuleList(nn.LayerNorm(D) for _ in range(self.ROUNDS))
        self.last = nn.Sequential(nn.Linear(D, D), nn.ReLU(), nn.Dropout(0.1),
                                  nn.Linear(D, len(Kind)))  # fmt: skip

    def forward(self, node: Tensor, near: Tensor, link: Tensor) -> Tensor:
        """Log odds (N, kinds) from the fields of `Surroundings`."""
        state = self.node(self.scale(node))
        there = link[:, :, -1:]
        gate = self.link(link) * there
        count = there.sum(dim=1).clamp(min=1)
        for say, tell, hear, norm in zip(self.say, self.tell, self.hear, self.norm, strict=True):
            quiet = norm(state)
            heard = say(quiet)[near] * gate
            loud, said = tell(quiet).chunk(2, dim=1)
            weight = torch.sigmoid(loud)
            everywhere = (weight * said).sum(dim=0, keepdim=True) / (1 + weight.sum(dim=0))
            parts = [heard.sum(dim=1) / count, heard.amax(dim=1), everywhere.expand_as(said)]
            state = state + hear(torch.cat([state, *parts], dim=1))
        found: Tensor = self.last(state)
        return found


def tensors_of(seen: Surroundings) -> tuple[Tensor, Tensor, Tensor]:
    """What the network takes."""
    return torch.from_numpy(seen.node), torch.from_numpy(seen.near), torch.from_numpy(seen.link)


def turned_at_random(rng: np.random.Generator) -> Floats:
    """A rotation (3, 3): a few degrees, seldom half round, mirrored along the row half the time."""
    yaw = math.radians(rng.normal(0, 5)) + math.pi * (rng.random() < 0.1)
    roll, pitch = np.radians(rng.normal(0, 1.5, 2))
    c, s = math.cos(yaw), math.sin(yaw)
    about_z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    cross = np.array([[0, 0, pitch], [0, 0, -roll], [-pitch, roll, 0]])
    tilt, _ = np.linalg.qr(np.eye(3) + cross)
    tilt = tilt * np.sign(np.diag(tilt))
    return np.asarray(np.diag([rng.choice([-1.0, 1.0]), 1, 1]) @ tilt @ about_z)


def kind_loss(found: Tensor, counts: Tensor) -> Tensor:
    """Cross entropy, superpoints weighing by the root of their points."""
    points = counts.sum(dim=1)
    share = counts / points.clamp(min=1)[:, None]
    each = -(torch.log_softmax(found, dim=1) * share).sum(dim=1)
    return (each * points.sqrt()).sum() / points.sqrt().sum()


def begun(start: Path | None) -> IsolationNet:
    """The network with the parameters of the file that it starts from, if any."""
    net = IsolationNet()
    if start is not None:
        go_on_from(start, net)
    return net


def train_isolation(
    training: list[RowExample], epochs: int, start: Path | None, rng: np.random.Generator
) -> Iterator[tuple[IsolationNet, float]]:
    """The network and its mean loss after each epoch; it goes on from the file `start`, if any."""
    torch.manual_seed(int(rng.integers(2**31)))
    net, rate = begun(start), RATE if start is None else GOING_ON
    pairs = [(one, tree) for one in training for tree in one.asked]
    optimizer = torch.optim.AdamW(net.parameters(), rate, weight_decay=1e-3)
    steps = epochs * math.ceil(len(pairs) / BATCH) + 1
    slower = torch.optim.lr_scheduler.OneCycleLR(optimizer, rate, total_steps=steps)
    for _ in range(epochs):
        net.train()
        total = 0.0
        for rows in np.array_split(rng.permutation(len(pairs)), math.ceil(len(pairs) / BATCH)):
            optimizer.zero_grad()
            for row in rows:
                loss = _loss_of(net, pairs[row], rng) / len(rows)
                loss.backward()  # type: ignore[no-untyped-call]
                total += float(loss.detach()) * len(rows)
            nn.utils.clip_grad_norm_(net.parameters(), 1.0)
            optimizer.step()
            slower.step()
        net.eval()
        yield net, total / max(len(pairs), 1)


def _loss_of(net: IsolationNet, pair: tuple[RowExample, int], rng: np.random.Generator) -> Tensor:
    example, tree = pair
    turn = turned_at_random(rng)
    base = turn @ (example.base[tree] + rng.normal(0, SEEN, 3))
    seen = example.pieces.turned(turn).seen_from(base)
    counts = torch.from_numpy(example.kinds(tree).astype(np.float32))
    return kind_loss(net(*tensors_of(seen)), counts)


@torch.no_grad()
def kept_and_removed(net: IsolationNet, examples: list[RowExample]) -> tuple[float, float]:
    """Mean shares: of the target's points kept, of all others but strays removed (raw scans)."""
    shares = []
    for example in examples:
        counts = example.kinds(0)
        others = counts[:, Kind.NEIGHBOUR : Kind.STRAY].sum(axis=1)
        if 0 not in example.asked or others.sum() < FEWEST:
            continue
        found = net(*tensors_of(example.pieces.seen_from(example.base[0]))).argmax(dim=1).numpy()
        kept = found == Kind.TARGET
        removed = others[~kept].sum() / others.sum()
        shares.append((counts[kept, 0].sum() / counts[:, 0].sum(), removed))
    if not shares:
        return math.nan, math.nan
    kept_share, removed_share = np.mean(shares, axis=0).tolist()
    return kept_share, removed_share


def isolation_bytes(net: IsolationNet, example: RowExample) -> bytes:
    """The network as an ONNX file that gives probabilities, for any number of superpoints."""
    inputs = tensors_of(example.pieces.seen_from(example.pieces.xyz[0]))
    return exported(Probable(net), inputs, ("node", "near", "link"), ("kind",), "superpoints")


class Probable(nn.Module):
    """The network as it ships: probabilities (N, kinds)."""

    def __init__(self, net: IsolationNet) -> None:
        super().__init__()
        self.net = net

    def forward(self, node: Tensor, near: Tensor, link: Tensor) -> Tensor:
        """Probabilities."""
        return torch.softmax(self.net(node, near, link), dim=1)
