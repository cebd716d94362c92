"""`python -m bench.refine [--trees 20] [--seed 960000]`: how near the refined tree is to the truth.

Each tree is scanned clean and as in the field, and refined from two skeletons: `true topology`, the
true tree with a node every 8 cm, each put 15 mm astray, 10 mm in front of the wood; and `chain`,
what `skeletonize` finds. `raw` is before, `refined` after. All samples of all trees together.

The six views of a field scan stand together some millimetres wrong, and so does the whole cloud:
nothing in it tells. `in the scan's place` compares with the true tree where the views show it, on
average; `in the true place` with where it stands.
"""

from __future__ import annotations

import argparse
import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from prunus.geometry.near import nearest, within
from prunus.lab.evaluate.compared import compared, one_to_one, overlap
from prunus.lab.evaluate.curves import sampled_rows
from prunus.lab.evaluate.seen import shown
from prunus.lab.experiment.orchard import tree_of
from prunus.lab.simulate.scan import Scan, simulate_scan
from prunus.lab.simulate.settings import Setting, scan_settings
from prunus.model import Bools, Floats, Label, PointCloud, Skeleton
from prunus.model.branches import Branch, branches
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.refine.refined import Refined, refined

SPACING, ASTRAY, BEFORE = 0.08, 0.015, 0.010
"""Of the nodes of the true topology, metres."""
NEAR = 0.05
"""A sample farther from any true wood is not off, but false: it counts in F1 alone."""
SEEN = 0.03
"""True wood counts where the scan holds a point so near."""
CLOSE = 0.02
"""Tolerance of F1."""
ALONG = 0.05
"""The direction of a branch is that of its first so many metres."""
Figures = dict[str, list[Floats]]


@dataclass(frozen=True, eq=False)
class Case:
    """One scan: points (P, 3) of the tree, its true skeleton, what of it counts, as it is seen.

    `place` is the true skeleton where the views show it, on average.
    """

    points: Floats
    truth: Skeleton
    counts: Bools
    place: Skeleton


def case_of(seed: int, setting: Setting) -> Case:
    """The scan of that seed."""
    tree = tree_of(seed, setting)
    place = as_shown(simulate_scan(seed, setting), setting)
    points = tree.cloud.to_input.apply(tree.cloud.xyz)
    return Case(points, tree.truth, tree.counts, place)


def as_shown(scan: Scan, setting: Setting) -> Skeleton:
    """The true tree where the views that have it in sight show it, on average."""
    rig, truth = scan_settings(setting).rig, scan.truth
    moved, count = np.zeros(truth.xyz.shape), np.zeros(len(truth))
    for view in scan.views:
        held = view.pose.inverse().apply(truth.xyz)
        aside = held[:, :2] / held[:, 2:] * scan.focal
        sees = (np.abs(aside) < [rig.width / 2, rig.height / 2]).all(axis=1)
        sees &= held[:, 2] < max(rig.far)
        moved[sees] += (view.nominal.apply(held) - truth.xyz)[sees]
        count += sees
    return replace(truth, xyz=truth.xyz + moved / np.maximum(count, 1)[:, None])


def thinned(truth: Skeleton, rng: np.random.Generator) -> Skeleton:
    """The true topology with few nodes, each astray."""
    kept = np.zeros(len(truth), np.bool_)
    for branch in branches(truth):
        way = truth.lengths[branch.rows[1:]].cumsum()
        stops = np.arange(SPACING * rng.uniform(0.4, 1.0), way[-1] - SPACING / 3, SPACING)
        kept[branch.rows[1:][np.searchsorted(way, stops)]] = True
        kept[branch.rows[[0, -1]]] = True
    above = truth.parent.copy()
    for row in range(1, len(truth)):
        if above[row] > 0 and not kept[above[row]]:
            above[row] = above[above[row]]
    rows = np.flatnonzero(kept)
    astray = rng.normal(0, ASTRAY / np.sqrt(3), (len(rows), 3)) - [0, BEFORE, 0]
    parent = np.concatenate([[-1], np.searchsorted(rows, above[rows[1:]])])
    return Skeleton.build(truth.xyz[rows] + astray, parent, truth.label[rows])


def measured(found: Skeleton, case: Case, true: Skeleton) -> Iterator[tuple[str, Floats]]:
    """Figures of one skeleton against a true one, both in the frame of the points."""
    ours, row = sampled_rows(found)
    theirs, their_row = sampled_rows(_dense(true))
    seen = np.diff(within(case.points, theirs, SEEN)[0]) > 0
    match = nearest(ours, theirs, NEAR)
    some = match >= 0
    some[some] = seen[match[some]]
    way = _dense(true).edge_vectors[their_row[match[some]]]
    off = ours[some] - theirs[match[some]]
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    off -= (off * way).sum(axis=1, keepdims=True) * way
    away = np.linalg.norm(off, axis=1)
    yield "off", away
    for label in Label:
        yield f"off {label.word}", away[found.label[row[some]] == label]
    yield from _covered(ours, theirs, shown(true, case.counts), case.points)
    yield from _junctions(found, shown(true, case.counts))


def _dense(tree: Skeleton) -> Skeleton:
    """The tree with ten nodes in place of each, so that samples of it lie 1 mm apart."""
    size, steps = len(tree), 10
    share = np.arange(1, steps + 1)[None, :, None] / steps
    start, end = tree.xyz[tree.parent[1:]][:, None], tree.xyz[1:][:, None]
    xyz = np.concatenate([tree.xyz[:1], (start + share * (end - start)).reshape(-1, 3)])
    last = np.concatenate([[0], np.arange(1, size) * steps])
    parent = np.arange(-1, len(xyz) - 1)
    parent[1::steps] = last[tree.parent[1:]]
    rows = np.concatenate([[0], np.repeat(np.arange(1, size), steps)])
    return Skeleton.build(xyz, parent, tree.label[rows], radius=tree.radius[rows])


def _covered(
    ours: Floats, theirs: Floats, asked: Skeleton, points: Floats
) -> Iterator[tuple[str, Floats]]:
    """Which of our samples are near true wood, and which of the seen wood that counts near ours."""
    yield "precise", (nearest(ours, theirs, CLOSE) >= 0).astype(float)
    wood = sampled_rows(asked)[0]
    wood = wood[np.diff(within(points, wood, SEEN)[0]) > 0]
    yield "recalled", (nearest(wood, ours, CLOSE) >= 0).astype(float)


def _junctions(found: Skeleton, true: Skeleton) -> Iterator[tuple[str, Floats]]:
    """How far the feet of side branches are off, and their directions, degrees."""
    ours, theirs = compared(found, true)
    both = np.where(theirs.shared >= 0.5 * theirs.samples[:, None], overlap(ours, theirs), 0)
    for t, q in one_to_one(both):
        pair = theirs.branches[t], ours.branches[q]
        if any(branch.label != Label.SIDE_BRANCH for branch in pair):
            continue
        feet = true.xyz[pair[0].rows[0]], found.xyz[pair[1].rows[0]]
        yield "foot", np.array([np.linalg.norm(feet[0] - feet[1])])
        cosine = _way(true, pair[0]) @ _way(found, pair[1])
        yield "turn", np.degrees(np.arccos(np.clip([cosine], -1, 1)))


def _way(tree: Skeleton, branch: Branch) -> Floats:
    along = np.concatenate([[0], tree.lengths[branch.rows[1:]].cumsum()])
    line = tree.xyz[branch.rows]
    point = np.array([np.interp(ALONG, along, line[:, axis]) for axis in range(3)]) - line[0]
    return np.asarray(point / np.linalg.norm(point))


def radii(found: Refined, skeleton: Skeleton, true: Skeleton) -> Iterator[tuple[str, Floats]]:
    """Errors of the radii, metres, as shares of the radius, and in standard deviations."""
    match = nearest(skeleton.xyz, true.xyz, NEAR)
    some = (match >= 0) & (true.label[match] == skeleton.label)
    known = some & np.isfinite(skeleton.radius)
    wrong = np.abs(skeleton.radius - true.radius[match])
    for name, labels in GROUPS.items():
        rows = known & np.isin(skeleton.label, labels)
        yield f"radius {name}", wrong[rows]
        yield f"share {name}", (wrong / true.radius[match])[rows]
        yield f"sigmas {name}", (wrong / found.radius_error)[rows]
        yield f"known {name}", known[some & np.isin(skeleton.label, labels)].astype(float)


GROUPS: dict[str, tuple[Label, ...]] = {
    "trunk, support": (Label.TRUNK, Label.SUPPORT),
    "leader": (Label.LEADER,),
    "side branch": (Label.SIDE_BRANCH,),
}


def measure(seeds: range, setting: Setting) -> dict[str, Figures]:
    """All figures, by what was refined and how it is compared."""
    figures: dict[str, Figures] = defaultdict(lambda: defaultdict(list))
    for seed in seeds:
        case = case_of(seed, setting)
        cloud = PointCloud.from_xyz(case.points)
        start = thinned(shown(case.truth, case.counts), np.random.default_rng(seed))
        result = skeletonize(
            cloud, case.truth.xyz[0], Parameters().changed("isolation", isolate="never")
        )
        for name, raw in (("true topology", start), ("chain", result.skeleton)):
            house = raw.moved(cloud.to_input.inverse())
            before = time.process_time()
            found = refined(house, cloud)
            spent = time.process_time() - before
            after = found.skeleton.moved(cloud.to_input)
            held = figures[f"{name}, refined, in the scan's place"]
            held["cpu"].append(np.array([spent]))
            _keep(held, radii(found, after, case.place))
            _keep(held, measured(after, case, case.place))
            _keep(figures[f"{name}, refined, in the true place"], measured(after, case, case.truth))
            _keep(figures[f"{name}, raw, in the scan's place"], measured(raw, case, case.place))
            _keep(figures[f"{name}, raw, in the true place"], measured(raw, case, case.truth))
        _keep(figures["the scan's place itself"], [("off", _moved(case))])
    return figures


def _moved(case: Case) -> Floats:
    seen = np.diff(within(case.points, case.place.xyz, SEEN)[0]) > 0
    return np.asarray(np.linalg.norm(case.place.xyz - case.truth.xyz, axis=1)[seen])


def _keep(held: Figures, values: Iterator[tuple[str, Floats]] | list[tuple[str, Floats]]) -> None:
    for name, column in values:
        held[name].append(column)


def lines_of(figures: dict[str, Figures]) -> Iterator[str]:
    """What is printed of them."""
    for name, columns in sorted(figures.items()):
        all_ = {key: np.concatenate(parts) for key, parts in columns.items()}
        yield name
        yield f"  off, mm: 50 %, 95 %: {_both(all_['off'])}" + "".join(
            f"; {label.word} {_both(all_[f'off {label.word}'])}"
            for label in Label
            if len(all_.get(f"off {label.word}", ()))
        )
        if "precise" in all_:
            both = all_["precise"].mean(), all_["recalled"].mean()
            yield (f"  at 2 cm: precision {both[0]:.3f}, recall {both[1]:.3f}, "
                   f"F1 {2 * both[0] * both[1] / sum(both):.3f}")  # fmt: skip
        if len(all_.get("foot", ())):
            yield (f"  side branches ({len(all_['foot'])}): foot off {_mm(all_['foot'], 50)} mm, "
                   f"direction {np.median(all_['turn']):.1f} degrees")  # fmt: skip
        if "cpu" in all_:
            yield f"  CPU s: 50 % {np.median(all_['cpu']):.3f}, most {all_['cpu'].max():.3f}"
            yield from _radius_lines(all_)


def _radius_lines(columns: dict[str, Floats]) -> Iterator[str]:
    for name in GROUPS:
        wrong, share, sigmas = (columns[f"{key} {name}"] for key in ("radius", "share", "sigmas"))
        if len(wrong):
            known = columns[f"known {name}"].mean()
            yield (f"  radius, {name}: off {_mm(wrong, 50)} mm, {np.median(share):.0%}; "
                   f"95 % {_mm(wrong, 95)} mm; within one sigma {(sigmas < 1).mean():.0%}, two "
                   f"{(sigmas < 2).mean():.0%}; known {known:.0%}")  # fmt: skip


def _both(values: Floats) -> str:
    return f"{_mm(values, 50)}, {_mm(values, 95)}"


def _mm(values: Floats, percent: float) -> str:
    return f"{1e3 * np.percentile(values, percent):.1f}" if len(values) else "-"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=20)
    parser.add_argument("--seed", type=int, default=960_000)
    chosen = parser.parse_args()
    settings: tuple[Setting, ...] = ("clean", "hard")
    for setting in settings:
        print(f"== {setting}")
        for line in lines_of(measure(range(chosen.seed, chosen.seed + chosen.trees), setting)):
            print(line)


if __name__ == "__main__":
    main()
