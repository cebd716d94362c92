"""One school year: examples from a folder of simulated scans, training, tables, weights."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from prunus.errors import PrunusError
from prunus.io.safely import write_bytes
from prunus.io.scans import scans_in
from prunus.learn.examples import Example, examples_of, split_by_tree
from prunus.learn.tables import measures
from prunus.params import Parameters

Item = TypeVar("Item")
Watch = Callable[[Iterable[Item], str, int], Iterable[Item]]
"""Shows progress: items as they come, under a name, out of so many."""


def school(
    folder: Path,
    weights: Path,
    edge_net: str,
    seed: int,
    epochs: int | None,
    jobs: int,
    watch: Watch[Any],
) -> dict[str, Any]:
    """Train a network on the scans in a folder; writes `weights` and beside it the tables as JSON.

    Returns what was written: measures on validation and test trees, and how it was made.
    """
    try:
        from prunus.learn import train
    except ImportError as error:
        raise PrunusError("training needs torch and onnx: pip install 'prunus[train]'") from error
    rng = np.random.default_rng(seed)
    folders = split_by_tree(scans_in(folder), rng)
    cover = (Parameters.paper() if edge_net == "paper" else Parameters()).superpoints
    sets = []
    for names, what in zip(folders, ("training", "validation", "test"), strict=True):
        made = watch(examples_of(names, seed, jobs, cover), f"{what} examples", len(names))
        sets.append([example for of_scan in made for example in of_scan])
    training, validation, test = sets
    recipe = train.RECIPES[edge_net]()
    recipe.epochs = epochs or recipe.epochs
    recipe.weights = train.even_weights(training) if edge_net == "ours" else None
    best = None
    losses = []
    for net, loss in watch(train.train(recipe, training, validation, rng), "epochs", recipe.epochs):
        best = net
        losses.append(loss)
    if best is None:
        raise PrunusError("no epochs; expected at least one")
    made_up = train.calibrated(best, recipe, validation)
    report = {
        "edge_net": edge_net, "seed": seed, "epochs": recipe.epochs,
        "trees": [len(names) for names in folders], "edges": [_edges(own) for own in sets],
        "validation_losses": losses,
        "validation": measures(*train.predict(made_up, recipe, validation)),
        "test": measures(*train.predict(made_up, recipe, test)),
    }  # fmt: skip
    write_bytes(weights, train.onnx_bytes(made_up, recipe, edge_net, test[0]))
    write_bytes(weights.with_suffix(".json"), json.dumps(report, indent=1).encode())
    return report


TRAINING = 0.9
"""So large a share of the trees, by name, are for learning isolation; the rest are for the test."""


def isolation_school(
    folder: Path, weights: Path, seed: int, epochs: int | None, jobs: int, watch: Watch[Any]
) -> dict[str, Any]:
    """Train the isolation network on the scans in a folder; writes `weights` and a JSON beside it.

    Returns what was written: the shares kept and removed on test trees, and how it was made.
    """
    try:
        from prunus.learn import isolation
    except ImportError as error:
        raise PrunusError("training needs torch and onnx: pip install 'prunus[train]'") from error
    folders = scans_in(folder)
    if len(folders) < 5:
        raise PrunusError(f"{folder}: {len(folders)} simulated trees; expected at least 5")
    made = list(watch(isolation.row_examples(folders, seed, jobs), "examples", len(folders)))
    first_test = int(TRAINING * len(folders))
    training = [example for of_scan in made[:first_test] for example in of_scan]
    test = [example for of_scan in made[first_test:] for example in of_scan]
    epochs = epochs or isolation.EPOCHS
    rng, losses = np.random.default_rng(seed), []
    for net, loss in watch(isolation.train_isolation(training, epochs, rng), "epochs", epochs):
        last = net
        losses.append(loss)
    report = {
        "network": "isolation", "seed": seed, "epochs": epochs,
        "trees": [first_test, len(folders) - first_test], "losses": losses,
        "test": isolation.kept_and_removed(last, test),
    }  # fmt: skip
    write_bytes(weights, isolation.isolation_bytes(last, test[0]))
    write_bytes(weights.with_suffix(".json"), json.dumps(report, indent=1).encode())
    return report


def _edges(examples: list[Example]) -> int:
    return sum(len(example.category) for example in examples)
