"""`python -m bench.fit_handmade`: fit the weights of the hand-made scorer to simulated truth.

Pairs of trees, one behind the other as the two rows of a V, with scans of different density and
smear. An edge is true when it stays within 5 cm of one tree, the nearer one all along, and the way
between its ends along that tree is about as long as the edge. Split by pair: 16 to fit, 8 to test.
"""

from __future__ import annotations

import numpy as np

from prunus.model import Bools, CandidateGraph, Floats, Ints, PointCloud, RigidMotion, Skeleton
from prunus.params import Parameters
from prunus.simulate import Faults, grow_tree, scan_tree
from prunus.stages.candidates import find_candidates
from prunus.stages.confidence import image_features
from prunus.stages.images import edge_images
from prunus.stages.superpoints import find_superpoints

NEAR = 0.05
SAMPLES = np.linspace(0, 1, 7)[:, None]


def main() -> None:
    """Fit, and say how well the fit does on pairs it has not seen."""
    fitted = [labelled_pair(seed) for seed in range(1000, 1016)]
    weights = fit_logistic(*(np.concatenate(part) for part in zip(*fitted, strict=True)))
    unseen = [labelled_pair(seed) for seed in range(1016, 1024)]
    features, valid = (np.concatenate(part) for part in zip(*unseen, strict=True))
    confidence = 1 / (1 + np.exp(-(features @ weights[:-1] + weights[-1])))
    print("WEIGHTS", np.round(weights[:-1], 2), "OFFSET", round(weights[-1], 2))
    print(f"{len(valid)} unseen edges, {valid.mean():.0%} of them true")
    print(f"accuracy {((confidence > 0.5) == valid).mean():.3f}, AUC {area(confidence, valid):.3f}")
    for low in np.arange(0, 1, 0.1):
        chosen = (confidence >= low) & (confidence < low + 0.1)
        print(f"  confidence {low:.1f} to {low + 0.1:.1f}: {valid[chosen].mean():.2f} true")


def labelled_pair(seed: int) -> tuple[Floats, Bools]:
    """Features (E, 4) of the candidate edges of a scanned pair of trees, and which are true."""
    rng = np.random.default_rng(seed)
    trees = [grow_tree(rng), grow_tree(rng)]
    smear = np.array(Faults().smear) * rng.uniform(0.5, 1.1)
    faults = Faults(points=int(rng.uniform(25_000, 50_000)), smear=tuple(smear.tolist()))
    clouds = [scan_tree(tree, rng, faults) for tree in trees]
    behind = np.array([rng.uniform(-1.2, 1.2), rng.uniform(0.25, 0.6), 0])
    trees[1] = trees[1].moved(RigidMotion(np.eye(3), behind))
    points = [cloud.to_input.apply(cloud.xyz) for cloud in clouds]
    both = PointCloud.from_xyz(np.concatenate([points[0], points[1] + behind]))
    cloud = both.sample(int(rng.uniform(25_000, 60_000)), rng)
    graph = find_candidates(find_superpoints(cloud, Parameters().superpoints, rng))
    nodes = cloud.to_input.apply(graph.xyz)
    lengths = np.linalg.norm(np.diff(nodes[graph.edges], axis=1)[:, 0], axis=1)
    features = image_features(edge_images(graph), lengths / graph.superpoints.radius)
    return features, true_edges(graph, nodes, lengths, trees)


def true_edges(
    graph: CandidateGraph, nodes: Floats, lengths: Floats, trees: list[Skeleton]
) -> Bools:
    """Which candidate edges (E,) follow the wood of one tree."""
    valid = np.zeros(len(graph.edges), np.bool_)
    for e, (i, j) in enumerate(graph.edges):
        samples = nodes[i] * (1 - SAMPLES) + nodes[j] * SAMPLES
        distance = [np.linalg.norm(samples[:, None] - tree.xyz, axis=2) for tree in trees]
        owner = np.argmin([far.min(axis=1) for far in distance], axis=0)
        if (owner != owner[0]).any() or distance[owner[0]].min(axis=1).max() >= NEAR:
            continue
        nearest = distance[owner[0]].argmin(axis=1)
        way = way_along(trees[owner[0]], int(nearest[0]), int(nearest[-1]))
        valid[e] = 0.5 * lengths[e] < way < 1.25 * lengths[e] + 0.04
    return valid


def way_along(tree: Skeleton, first: int, second: int) -> float:
    """The way between two rows along a tree, metres."""
    lengths, total = tree.lengths, 0.0
    while first != second:
        first, second = max(first, second), min(first, second)
        total += lengths[first]
        first = int(tree.parent[first])
    return float(total)


def fit_logistic(features: Floats, valid: Bools) -> Floats:
    """Weights and offset of a logistic regression, by Newton's method."""
    columns = np.column_stack([features, np.ones(len(features))])
    weights = np.zeros(columns.shape[1])
    for _ in range(60):
        guess = 1 / (1 + np.exp(-columns @ weights))
        slope = columns.T @ (valid - guess) - 0.01 * weights
        bend = (columns.T * (guess * (1 - guess))) @ columns + 0.01 * np.eye(len(weights))
        weights += np.linalg.solve(bend, slope)
    return weights


def area(score: Floats, valid: Bools) -> float:
    """Area under the ROC curve."""
    rank: Ints = np.argsort(np.argsort(score))
    true, false = valid.sum(), (~valid).sum()
    return float((rank[valid].sum() - true * (true - 1) / 2) / (true * false))


if __name__ == "__main__":
    main()
