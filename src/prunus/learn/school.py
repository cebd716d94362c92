"""One school year: examples from folders of trees, training, tables, weights."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import OptionError, PrunusError, blaming_the_command
from prunus.io.safely import write_bytes
from prunus.io.scans import scans_in
from prunus.learn.examples import Example
from prunus.learn.lessons import Sources, Watch, lessons_from
from prunus.learn.tables import measures, table
from prunus.names import as_text
from prunus.networks import WEIGHTS
from prunus.params import Parameters
from prunus.stages.networks import shipped_or_own


@dataclass(frozen=True)
class Course:
    """How an edge network is trained.

    edge_net: ours or paper; start: the network to go on from, `ours`, `paper`, a file or `scratch`;
    None = the shipped one where people labelled edges, else scratch; epochs: None = as the recipe
    has it; scans: where labelled scans lie, None = looked for.
    """

    edge_net: str = "ours"
    start: str | None = None
    seed: int = 0
    epochs: int | None = None
    scans: Path | None = None

    def begins(self, sources: Sources) -> Path | None:
        """The file of the network to start from."""
        start = self.start or (self.edge_net if sources.labelled else "scratch")
        return None if start == "scratch" else shipped_or_own(start)


def school(
    folders: list[Path], weights: Path, course: Course, jobs: int, watch: Watch[Any]
) -> dict[str, Any]:
    """Train a network on the trees in some folders; writes `weights` and beside it a JSON.

    Returns what was written: measures on validation and test trees, and how it was made; where it
    went on from another network also `before`, what that one has on the test trees.
    """
    try:
        from prunus.learn import recipes, train
    except ImportError as error:
        raise OptionError("training needs torch and onnx: pip install 'prunus[train]'") from error
    sources = Sources.among(folders)
    name = course.edge_net
    recipe = recipes.recipe_for(name, course.begins(sources), course.epochs)
    with blaming_the_command():
        recipe.network()
    rng = np.random.default_rng(course.seed)
    cover = (Parameters.paper() if name == "paper" else Parameters.learned()).superpoints
    lessons = lessons_from(sources, course.scans, course.seed, jobs, cover, watch, rng)
    training, validation, test = lessons.sets
    report: dict[str, Any] = {
        "edge_net": name, "seed": course.seed, "epochs": recipe.epochs, "trees": lessons.trees,
        "edges": [_edges(own) for own in lessons.sets], "labels": lessons.labels,
        "from": _called(recipe.start), "notes": lessons.notes,
    }  # fmt: skip
    if recipe.start is not None:
        net = train.finished(recipe.network(), recipe, validation)
        report["before"] = measures(*train.predict(net, recipe, test))
    recipe.weights = train.even_weights(training) if name == "ours" else None
    made = train.train(recipe, training, validation, rng)
    nets, losses = zip(*watch(made, "epochs", recipe.epochs), strict=True)
    net = train.finished(nets[-1], recipe, validation)
    report |= {
        "validation_losses": losses,
        "validation": measures(*train.predict(net, recipe, validation)),
        "test": measures(*train.predict(net, recipe, test)),
    }
    write_bytes(weights, train.onnx_bytes(net, recipe, name, test[0]))
    write_bytes(weights.with_suffix(".json"), json.dumps(report, indent=1).encode())
    return report


def _called(start: Path | None) -> str | None:
    """A network by its name, where it is one that ships."""
    if start is None:
        return None
    return start.stem if start.parent == WEIGHTS else as_text(start)


def lines_of(report: dict[str, Any]) -> list[str]:
    """What to say of a training: notes, the paper's tables, and what it brought."""
    lines = [f"note: {note}" for note in report["notes"]]
    lines += table(report["validation"], report["test"])
    if "before" in report:
        name = "edge validity of the test edges"
        before, after = (report[key]["validity_accuracy"] for key in ("before", "test"))
        lines += ["", f"{name}: {before:.1%} with {report['from']}, {after:.1%} now"]
    return lines


TRAINING = 0.9
"""So large a share of the trees, by name, are for learning isolation; the rest are for the test."""


def isolation_school(
    inputs: list[Path], weights: Path, course: Course, jobs: int, watch: Watch[Any]
) -> dict[str, Any]:
    """Train the isolation network on simulated scans; writes `weights` and a JSON beside it.

    Of the course its start, a file, its seed and its epochs count.

    Returns what was written: the shares kept and removed on test trees, and how it was made.
    """
    try:
        from prunus.learn import isolation
    except ImportError as error:
        raise OptionError("training needs torch and onnx: pip install 'prunus[train]'") from error
    folders = [scan for folder in inputs for scan in scans_in(folder)]
    if len(folders) < 5:
        raise PrunusError(f"{inputs[0]}: {len(folders)} simulated trees; expected at least 5")
    seed, start = course.seed, None if course.start in (None, "scratch") else Path(course.start)
    with blaming_the_command():
        isolation.begun(start)
    made = list(watch(isolation.row_examples(folders, seed, jobs), "examples", len(folders)))
    first_test = int(TRAINING * len(folders))
    training = [example for of_scan in made[:first_test] for example in of_scan]
    test = [example for of_scan in made[first_test:] for example in of_scan]
    epochs = course.epochs or (isolation.EPOCHS if start is None else isolation.MORE)
    rng, losses = np.random.default_rng(seed), []
    trained = isolation.train_isolation(training, epochs, start, rng)
    for net, loss in watch(trained, "epochs", epochs):
        last = net
        losses.append(loss)
    report = {
        "network": "isolation", "seed": seed, "epochs": epochs,
        "from": start and as_text(start.name),
        "trees": [first_test, len(folders) - first_test], "losses": losses,
        "test": isolation.kept_and_removed(last, test),
    }  # fmt: skip
    write_bytes(weights, isolation.isolation_bytes(last, test[0]))
    write_bytes(weights.with_suffix(".json"), json.dumps(report, indent=1).encode())
    return report


def _edges(examples: list[Example]) -> int:
    """How many edges are told of, an edge seen in two draws counting twice."""
    return sum(int(example.told.sum()) for example in examples)
