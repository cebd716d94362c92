"""The edit ratio by length: what is wrong with a skeleton, in metres (docs/evaluation.md).

It needs no superpoints, so that any tool's skeleton can be compared. Skeleton and truth are cut
into pieces of a centimetre, and each piece of the one is paired with at most one of the other:
two strands along one branch are one too many.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import maximum_flow
from scipy.spatial import cKDTree

from prunus.geometry.pieces import matrix_of
from prunus.lab.evaluate.along import Pieces, asked_of, pieces_of
from prunus.lab.evaluate.correction import STAYS
from prunus.lab.evaluate.curves import SPACING, covered
from prunus.model import Bools, Ints, Label, Skeleton

ASIDE = math.radians(45)
"""Two pieces go the same way when their directions differ by less, either way round."""
LEEWAY = 0.10
"""Where both change from one label to another within so many metres, either label is right."""
NONE = -1


@dataclass(frozen=True, kw_only=True)
class LengthEdits:
    """What must be done to a skeleton S to make it the truth, in metres.

    `wrong` lies on no true wood that is asked for, `unasked` of it on true wood that is not;
    `missing` is truth that S does not have; `mislabelled` is in both, under different labels;
    `length` is that of the truth. `geometry_*`: labels ignored. By label: what is `differing`,
    wrong or missing under that label, and its length in the truth.
    """

    wrong: float
    missing: float
    mislabelled: float
    length: float
    unasked: float
    geometry_wrong: float
    geometry_missing: float
    differing: dict[Label, float]
    lengths: dict[Label, float]

    @property
    def ratio(self) -> float:
        """The edit ratio by length; NaN where nothing is asked for."""
        return _share(self.wrong + self.missing + self.mislabelled, self.length)

    @property
    def geometry_ratio(self) -> float:
        """The same with labels ignored: for tools that have none."""
        return _share(self.geometry_wrong + self.geometry_missing, self.length)

    @property
    def label_accuracy(self) -> float:
        """Share of what both have that has the right label; NaN where they share nothing."""
        both = self.length - self.missing
        return _share(both - self.mislabelled, both)

    @property
    def label_ratios(self) -> dict[Label, float]:
        """Of each label what is wrong and missing over its length; NaN where there is none."""
        return {label: _share(self.differing[label], self.lengths[label]) for label in Label}


def edits_by_length(predicted: Skeleton, truth: Skeleton, counts: Bools) -> LengthEdits:
    """The edits that turn a skeleton into the true one, both in one frame.

    `counts` (M,) are the rows of the true tree that count, see `counting_rows`: each of
    their branches is asked for from its foot to the last of them.
    """
    ours = pieces_of(predicted)
    asked, rest = asked_of(truth, counts)
    near = _near(ours, asked)
    labelled, had, mislabelled = _matched(ours, asked, near)
    geometry = int((_paired(near, len(ours), len(asked)) != NONE).sum())
    wrong = ~labelled & ~mislabelled
    stray = np.intersect1d(np.flatnonzero(wrong), _near(ours, rest)[0])
    missing = len(asked) - int(had.sum()) - int(mislabelled.sum())
    differing = _by_label(ours.label[~labelled]) + _by_label(asked.label[~had])
    return LengthEdits(
        wrong=SPACING * int(wrong.sum()),
        missing=SPACING * missing,
        mislabelled=SPACING * int(mislabelled.sum()),
        length=SPACING * len(asked),
        unasked=SPACING * len(stray),
        geometry_wrong=SPACING * (len(ours) - geometry),
        geometry_missing=SPACING * (len(asked) - geometry),
        differing=dict(zip(Label, (SPACING * differing).tolist(), strict=True)),
        lengths=dict(zip(Label, (SPACING * _by_label(asked.label)).tolist(), strict=True)),
    )


def _matched(ours: Pieces, asked: Pieces, near: Ints) -> tuple[Bools, Bools, Bools]:
    """Which of ours are right (S,), which of the truth is had (T,), which of ours is mislabelled.

    Pairs of one label come first; what they leave is paired whatever its label.
    """
    size = len(ours), len(asked)
    pair = _paired(near[:, _agree(ours, asked, near)], *size)
    right, had = pair != NONE, np.zeros(len(asked), np.bool_)
    had[pair[right]] = True
    left = near[:, ~right[near[0]] & ~had[near[1]]]
    return right, had, _paired(left, *size) != NONE


def _by_label(labels: Ints) -> Ints:
    return np.bincount(labels, minlength=len(Label))


def on_true_wood(ours: Pieces, branch: Ints, truth: Skeleton, labelled: bool) -> Bools:
    """Which pieces (S,) of branches (S,) lie on true wood, under their label where `labelled`.

    All of the true tree counts. A piece of it is had by the branch that lies nearest to it: of two
    strands along one branch one is wrong.
    """
    theirs = pieces_of(truth)
    near = _near(ours, theirs)
    if labelled:
        near = near[:, _agree(ours, theirs, near)]
    one, other = near
    away = np.linalg.norm(ours.xyz[one] - theirs.xyz[other], axis=1)
    order = np.argsort(-away, kind="stable")
    had_by = np.full(len(theirs), NONE)
    had_by[other[order]] = branch[one[order]]  # the nearest comes last
    right = np.zeros(len(ours), np.bool_)
    right[one[had_by[other] == branch[one]]] = True
    return right


def geometry_f1(predicted: Skeleton, truth: Skeleton, counts: Bools, tolerance: float) -> float:
    """F1 of the geometry at a tolerance, metres, of the same pieces.

    Recall is of the truth that is asked for; precise is what lies on any wood of the tree.
    """
    ours = pieces_of(predicted)
    asked, rest = asked_of(truth, counts)
    recall = covered(asked.xyz, ours.xyz, tolerance)
    precision = covered(ours.xyz, np.concatenate([asked.xyz, rest.xyz]), tolerance)
    return 2 * recall * precision / (recall + precision) if recall > 0 else recall


def _near(ours: Pieces, theirs: Pieces) -> Ints:
    """Pairs (2, N) of pieces, ours and theirs, that lie near each other and go the same way."""
    if len(ours) == 0 or len(theirs) == 0:
        return np.zeros((2, 0), np.int64)
    away = cKDTree(ours.xyz).sparse_distance_matrix(
        cKDTree(theirs.xyz), STAYS, output_type="coo_matrix"
    )
    one, other = away.row.astype(np.int64), away.col.astype(np.int64)
    cosine = np.abs((ours.way[one] * theirs.way[other]).sum(axis=1))
    along = cosine > math.cos(ASIDE)
    return np.stack([one[along], other[along]])


def _agree(ours: Pieces, theirs: Pieces, pairs: Ints) -> Bools:
    """Which pairs have one label, or two of which both trees change one to the other close by."""
    one, other = pairs
    label, true = ours.label[one], theirs.label[other]
    here, there = ours.turns(LEEWAY)[one], theirs.turns(LEEWAY)[other]
    both, pair = here & there, np.arange(len(label))
    return np.asarray((label == true) | both[pair, label, true] | both[pair, true, label])


def _paired(pairs: Ints, ours: int, theirs: int) -> Ints:
    """The partner (ours,) of each piece of ours when as many as can be have one; else -1.

    A maximum flow (Dinic's algorithm) from a source by way of ours, then theirs, to a sink. On
    some trees scipy's own matching takes minutes for what this does in 50 ms.
    """
    source, sink = 0, ours + theirs + 1
    one, other = 1 + pairs[0], 1 + ours + pairs[1]
    mine, yours = np.arange(1, ours + 1), np.arange(ours + 1, sink)
    start = np.concatenate([np.full(ours, source), one, yours])
    end = np.concatenate([mine, other, np.full(theirs, sink)])
    capacity = matrix_of(np.column_stack([start, end]), np.ones(len(start), np.int32), sink + 1)
    used = coo_array(maximum_flow(capacity, source, sink).flow)
    kept = (used.data > 0) & (used.row > source) & (used.row <= ours)
    partner = np.full(ours, NONE)
    partner[used.row[kept] - 1] = used.col[kept] - 1 - ours
    return partner


def _share(part: float, whole: float) -> float:
    return part / whole if whole > 0 else math.nan
