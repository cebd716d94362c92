"""Examples from trees that a person corrected in the studio.

What they drew is wood, with the role of its label; what they marked as ground, post, wire or stray
is none. Of all other points nobody knows: people draw no spurs, and no neighbours.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from prunus.editing.acts import Mark, Rebuild
from prunus.editing.marks import chosen
from prunus.errors import PrunusError
from prunus.files.work_folder import MASK
from prunus.io.clouds.classes import kinds_of
from prunus.lab.experiment.gold import Corrected, with_nodes_every
from prunus.lab.learn.field.examples import FieldExample
from prunus.lab.simulate.wide.points import UNTOLD, PointTruth, on_axis, roles_of
from prunus.model import Bools, Floats, Ints, Kind, PointCloud, Role, Skeleton
from prunus.refine.refined import refined
from prunus.result import REFINED_WITH
from prunus.session.graphfile import read_graph
from prunus.session.graphs import FIRST, Graphs
from prunus.session.journal import Journal
from prunus.session.timeline import Timeline

STREAM = 9  # so that the points kept are drawn independently of others
DRAWN_M = 0.02  # a corrected skeleton is given nodes so far apart to look for points around it
AROUND_M = 0.15  # points so near to it are looked at to refine it
REACH_M = 0.015  # a point so near to the surface of a branch is of it
THIN_M = 0.005  # the radius of a branch of which none is known
LOOKED_AT = 24  # edges of a refined skeleton, a centimetre each, nearest to a point
NO_WOOD = (Kind.GROUND, Kind.POST, Kind.WIRE, Kind.STRAY)


@dataclass(frozen=True, eq=False)
class Marks:
    """What each point (P,) of a scan is, and of which of them a person said so."""

    kind: Ints
    told: Bools


def make_corrected(subjects: Sequence[Corrected], paths: Sequence[Path]) -> Iterator[None]:
    """Make the examples of corrected trees that are not there yet."""
    for subject, path in zip(subjects, paths, strict=True):
        if not path.exists():
            corrected_example(subject).write(path)
        yield


def corrected_example(subject: Corrected) -> FieldExample:
    """The example of one corrected tree; PrunusError where its scan is not found."""
    skeleton, _, scan, journal = subject.opened()
    marks = marks_of(subject.folder, journal, scan.cloud)
    truth = drawn_truth(skeleton.moved(scan.cloud.to_input.inverse()), scan.cloud, marks)
    example = FieldExample(xyz=scan.cloud.xyz, kind=marks.kind, truth=truth)
    return example.thinned(np.random.default_rng(STREAM))


def marks_of(folder: Path, journal: Journal | None, cloud: PointCloud) -> Marks:
    """What the journal says of the points: the marks that stand, one after another.

    They are done again on what the machine had taken the points for, where that was kept.
    """
    graphs, told = Graphs(folder), np.zeros(len(cloud), np.bool_)
    kind, marked = _kinds(graphs.path(FIRST), cloud), False
    timeline = Timeline.of(journal.lines if journal else ())
    for line in timeline.lines[: timeline.position]:
        if isinstance(line.move, Mark):
            where = chosen(line.move.where, cloud, kind.astype(np.int8))
            kind, told, marked = np.where(where, line.move.kind, kind), told | where, True
        elif isinstance(line.move, Rebuild) and not marked:
            kind = _kinds(graphs.path(line.number), cloud)
    mask = folder / MASK
    return Marks(kinds_of(mask, len(cloud)) if mask.exists() else kind, told)


def _kinds(path: Path, cloud: PointCloud) -> Ints:
    """What the machine took each point for; the tree, where nothing of that was kept."""
    every = np.full(len(cloud), int(Kind.TARGET))
    try:
        kind = read_graph(path).arrays["kind"] if path.exists() else every
    except PrunusError:  # the studio passes over such a file too
        return every
    return kind if len(kind) == len(cloud) else every


def drawn_truth(skeleton: Skeleton, cloud: PointCloud, marks: Marks) -> PointTruth:
    """The truth of the points of a cloud by a skeleton that a person drew, house frame.

    It is refined first: the axis and the radius of a branch come from the points around it.
    """
    xyz = cloud.xyz
    own = (marks.kind == Kind.TARGET) & _around(skeleton, xyz)
    points = cloud.take(own).sample(REFINED_WITH, np.random.default_rng(STREAM))
    tree = refined(skeleton, points).skeleton
    edges, row = tree.edge_vectors, _edge_of(tree, xyz)
    axis, radius = on_axis(tree, row, xyz), tree.radius[row]
    away, length = np.linalg.norm(xyz - axis, axis=1), tree.lengths[row, None]
    near = away <= _known(radius) + REACH_M
    near &= ~(marks.told & (marks.kind != Kind.TARGET))
    no_wood = marks.told & np.isin(marks.kind, NO_WOOD)
    roles, branch = roles_of(tree)
    return PointTruth(
        role=np.where(near, roles[row], np.where(no_wood, int(Role.NO_WOOD), UNTOLD)),
        branch=np.where(near, branch[row], np.where(no_wood, -1, -2)),
        axis=np.where(near[:, None], axis, xyz),
        radius=np.where(near, radius, 0.0),
        toward_foot=np.where(near[:, None], -edges[row] / np.maximum(length, 1e-9), 0.0),
    )


def _edge_of(tree: Skeleton, xyz: Floats) -> Ints:
    """The row (P,) in which that edge ends to whose surface each point (P, 3) is nearest.

    To whose axis it is nearest would say nothing where a twig leaves a thick branch.
    """
    middle = (tree.xyz - tree.edge_vectors / 2)[1:]
    away, edge = cKDTree(middle).query(xyz, min(LOOKED_AT, len(middle)))
    away, edge = away.reshape(len(xyz), -1), edge.reshape(len(xyz), -1)
    best = np.abs(away - _known(tree.radius)[1 + edge]).argmin(axis=1)
    return np.asarray(1 + edge[np.arange(len(xyz)), best])


def _known(radius: Floats) -> Floats:
    return np.where(np.isfinite(radius), radius, THIN_M)


def _around(skeleton: Skeleton, xyz: Floats) -> Bools:
    """Which points (P, 3) lie around a skeleton."""
    nodes = with_nodes_every(skeleton, DRAWN_M).xyz
    away, _ = cKDTree(nodes).query(xyz, distance_upper_bound=AROUND_M)
    return np.asarray(np.isfinite(away))
