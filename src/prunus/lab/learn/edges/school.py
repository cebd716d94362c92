"""One school year: examples from folders of trees, training, tables, weights."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import OptionError, blaming_the_command
from prunus.files.safely import write_bytes
from prunus.lab.learn.edges.examples import Example
from prunus.lab.learn.edges.lessons import Sources, Watch, lessons_from
from prunus.lab.learn.edges.tables import measures, table
from prunus.names import as_text
from prunus.paper.networks import shipped_or_own
from prunus.params import Parameters
from prunus.weights import WEIGHTS


@dataclass(frozen=True, kw_only=True)
class Course:
    """How an edge network is trained.

    start: the network to go on from, `paper`, a file or `scratch`; None = the shipped one where
    people labelled edges, else scratch; epochs: None = as the recipe has it; scans: where labelled
    scans lie, None = looked for.
    """

    start: str | None = None
    seed: int = 0
    epochs: int | None = None
    scans: Path | None = None

    def begins(self, sources: Sources) -> Path | None:
        """The file of the network to start from."""
        start = self.start or ("paper" if sources.labelled else "scratch")
        return None if start == "scratch" else shipped_or_own(start)


def school(
    folders: list[Path], weights: Path, course: Course, jobs: int, watch: Watch[Any]
) -> dict[str, Any]:
    """Train a network on the trees in some folders; writes `weights` and beside it a JSON.

    Returns what was written: measures on validation and test trees, and how it was made; where it
    went on from another network also `before`, what that one has on the test trees.
    """
    try:
        from prunus.lab.learn.edges import recipes, train
    except ImportError as error:
        raise OptionError("training needs torch and onnx: pip install 'prunus[train]'") from error
    sources = Sources.among(folders)
    recipe = recipes.recipe_for(course.begins(sources), course.epochs)
    with blaming_the_command():
        recipe.network()
    rng = np.random.default_rng(course.seed)
    cover = Parameters.paper().superpoints
    lessons = lessons_from(sources, course.scans, course.seed, jobs, cover, watch=watch, rng=rng)
    training, validation, test = lessons.sets
    report: dict[str, Any] = {
        "seed": course.seed, "epochs": recipe.epochs, "trees": lessons.trees,
        "edges": [_edges(own) for own in lessons.sets], "labels": lessons.labels,
        "from": _called(recipe.start), "notes": lessons.notes,
    }  # fmt: skip
    if recipe.start is not None:
        net = train.finished(recipe.network(), recipe, validation)
        report["before"] = measures(*train.predict(net, recipe, test))
    made = train.train(recipe, training, validation, rng)
    nets, losses = zip(*watch(made, "epochs", recipe.epochs), strict=True)
    net = train.finished(nets[-1], recipe, validation)
    report |= {
        "validation_losses": losses,
        "validation": measures(*train.predict(net, recipe, validation)),
        "test": measures(*train.predict(net, recipe, test)),
    }
    write_bytes(weights, train.onnx_bytes(net, recipe, test[0]))
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


def _edges(examples: list[Example]) -> int:
    """How many edges are told of, an edge seen in two draws counting twice."""
    return sum(int(example.told.sum()) for example in examples)
