"""`python -m bench.fit_handmade ORCHARD`: fit the weights of the hand-made scorer.

ORCHARD is a folder that `prunus simulate` wrote; its trees are split as for the networks.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from prunus.io.scans import scans_in
from prunus.learn.examples import Example, examples_in, split_by_tree
from prunus.learn.logistic import fit_logistic
from prunus.learn.tables import measures
from prunus.model import Bools, Floats
from prunus.params import Parameters
from prunus.stages.confidence import image_features

AT_RANDOM = Parameters.paper().superpoints
"""Superpoints as in the paper."""


def main(folder: Path) -> None:
    """Fit, and say how well the fit does on trees it has not seen."""
    fitted, validation, test = split_by_tree(scans_in(folder), np.random.default_rng(0))
    weights = fit_logistic(*features_of(fitted))
    print("WEIGHTS", np.round(weights[:-1], 2), "OFFSET", round(weights[-1], 2))
    judged = []
    for names in (validation, test):
        features, valid = features_of(names)
        confidence = 1 / (1 + np.exp(-(features @ weights[:-1] + weights[-1])))
        truth = np.where(valid, 0, -1)
        judged.append(measures(confidence, np.zeros(len(valid), np.int64), truth))
        print(f"{len(valid)} edges, AUC {area(confidence, valid):.3f}")
    for key in ("validity_accuracy", "calibration_error"):
        print(key, *(round(one[key], 3) for one in judged))


def features_of(folders: list[Path]) -> tuple[Floats, Bools]:
    """Features (E, 4) of all edges, and which are valid."""
    examples = [one for folder in folders for one in examples_in(folder, 0, AT_RANDOM)]
    return np.concatenate([features(one) for one in examples]), np.concatenate(
        [one.valid for one in examples]
    )


def features(example: Example) -> Floats:
    """What the hand-made scorer sees."""
    lengths = example.context.edge[:, 0].astype(np.float64)
    return image_features(example.images.astype(np.float32) / 255, lengths)


def area(score: Floats, valid: Bools) -> float:
    """Area under the ROC curve."""
    rank = np.argsort(np.argsort(score))
    true, false = valid.sum(), (~valid).sum()
    return float((rank[valid].sum() - true * (true - 1) / 2) / (true * false))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
