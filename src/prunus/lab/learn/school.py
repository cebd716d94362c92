"""`prunus train --network NAME`: examples, training, weights and a table, in one folder.

recipe.json      what the training is made from; another recipe is refused
examples/        what is learned from; held-out/ what the networks are compared by;
                 corrected/ both, of trees that a person corrected
checkpoint.pt    from which the same command goes on
log.jsonl        the losses, drawn in losses.html
NAME.onnx        the weights, and NAME.json how they were made and how well they do
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import nn

from prunus.errors import PrunusError, blaming_the_command
from prunus.files.safely import digest_of, write_bytes
from prunus.lab.experiment.gold import Corrected
from prunus.lab.learn.edges.lessons import FEWEST, Watch
from prunus.lab.learn.export import parameters_of
from prunus.lab.learn.field.corrected import make_corrected
from prunus.lab.learn.losses import PICTURE
from prunus.lab.learn.making import Example, Made, examples_to_make, make_examples
from prunus.lab.learn.recipe import FieldRecipe, Recipe, claim
from prunus.lab.learn.training import Lesson, Training, read_checkpoint, steps_done, train
from prunus.names import as_text

DIGITS = 16  # of a digest, enough to know a file by
Say = Callable[[str], None]
Figures = dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Learner:
    """All by which a network that learns from simulated scans differs from another.

    name: that of its weights; shipped: their file; net: the network as training begins; example:
    what is kept of a scan; lesson: the loss on one; onnx: the file of a network, traced on the
    example in a file; figures: how well a network in a file does on examples; table: of several.
    """

    name: str
    shipped: Path
    net: Callable[[], nn.Module]
    example: type[Example]
    lesson: Lesson
    onnx: Callable[[nn.Module, Path], bytes]
    figures: Callable[[Path, Iterable[Path]], Figures]
    table: Callable[[dict[str, Figures]], list[str]]

    def begun(self, start: Path | None, seed: int) -> nn.Module:
        """The network as training begins; PrunusError where the file holds none of this kind."""
        torch.manual_seed(seed)
        net = self.net()
        if start is None:
            return net
        if start.suffix == ".pt":
            held = read_checkpoint(start)["net"]
        else:
            held = parameters_of(start, net, self.name)
        try:
            net.load_state_dict(held)
        except RuntimeError as error:
            raise PrunusError(f"{start}: a checkpoint of a network of another form") from error
        return net


@dataclass(frozen=True, kw_only=True)
class Course:
    """A training of a network.

    learner: of which network; folder: where all of it is kept; corrected: trees that a person
    corrected; start: the network to go on from, `shipped` or a file (.onnx, or a checkpoint),
    `scratch` for none, None = the shipped one where there are corrected trees; jobs: examples made
    at the same time.
    """

    learner: Learner
    folder: Path
    recipe: Recipe
    corrected: Sequence[Corrected] = ()
    start: str | None = None
    jobs: int = 1

    @property
    def begins(self) -> Path | None:
        """The file of the network to go on from."""
        start = self.start or ("shipped" if self.corrected else "scratch")
        return {"scratch": None, "shipped": self.learner.shipped}.get(start, Path(start))

    @property
    def weights(self) -> Path:
        """The file of the weights to make."""
        return self.folder / f"{self.learner.name}.onnx"

    @property
    def share(self) -> float:
        """Of the steps, that on corrected trees."""
        return self.recipe.corrected.share if isinstance(self.recipe, FieldRecipe) else 0.0

    @property
    def named(self) -> dict[str, Corrected]:
        """The corrected trees by the names of their examples."""
        return {f"{k:03d}-{own.folder.name}": own for k, own in enumerate(self.corrected)}


def school(course: Course, watch: Watch[Any], say: Say) -> list[str]:
    """Train, or go on with it; writes weights and report. Returns what to say of it.

    PrunusError where the folder holds a training of another recipe, or of other trees.
    """
    recipe, folder, learner = course.recipe, course.folder, course.learner
    with blaming_the_command():
        net = learner.begun(course.begins, recipe.seed)
    made_from = _made_from(course)
    claim(folder, made_from)
    learned = _made(course, examples_to_make(folder / "examples", recipe.examples), watch)
    held_out = _made(course, examples_to_make(folder / "held-out", recipe.held_out), watch)
    own, own_held_out = split(_corrected(course, watch))
    training = Training(
        folder=folder,
        lesson=learner.lesson,
        simulated=learned,
        corrected=own,
        share=course.share,
        steps=recipe.from_scratch if course.begins is None else recipe.going_on,
        seed=recipe.seed,
    )
    net = _trained(training, net, watch, say)
    write_bytes(course.weights, learner.onnx(net, learned[0]))
    sets = {"simulated": held_out, "corrected": own_held_out}
    tables = {name: _compared(course, paths) for name, paths in sets.items() if paths}
    report = json.dumps(made_from | {"held_out": tables}, indent=1)
    write_bytes(course.weights.with_suffix(".json"), f"{report}\n".encode())
    return [*_notes(len(course.corrected)), *_lines(tables, course)]


def _made_from(course: Course) -> dict[str, Any]:
    """All that the weights depend on."""
    start = course.begins
    return {
        "recipe": course.recipe.model_dump(),
        "from": None if start is None else digest_of(start)[:DIGITS],
        "corrected": {as_text(name): own.made_of[:DIGITS] for name, own in course.named.items()},
    }


def split(corrected: list[Path]) -> tuple[list[Path], list[Path]]:
    """The examples of corrected trees to learn from, and those held out: none of a few trees."""
    if len(corrected) < FEWEST:
        return corrected, []
    held_out = corrected[FEWEST - 1 :: FEWEST]
    return [path for path in corrected if path not in held_out], held_out


def _made(course: Course, wanted: list[Made], watch: Watch[Any]) -> list[Path]:
    """The files of examples, those made that were missing, without those of no use."""
    missing = [one for one in wanted if not one.done]
    if missing:
        made = make_examples(missing, course.learner.example, min(course.jobs, len(missing)))
        for _ in watch(made, "examples", len(missing)):
            pass
    there = [one.path for one in wanted if one.path.exists()]
    if wanted and not there:
        raise PrunusError(f"{wanted[0].path.parent}: no scan to learn from; expected some")
    return there


def _corrected(course: Course, watch: Watch[Any]) -> list[Path]:
    """The files of the examples of the corrected trees."""
    paths = [course.folder / "corrected" / f"{name}.npz" for name in course.named]
    if not all(path.exists() for path in paths):
        for _ in watch(make_corrected(course.corrected, paths), "corrected trees", len(paths)):
            pass
    return paths


def _notes(corrected: int) -> list[str]:
    """What a person should know who brought so few trees."""
    if not 0 < corrected < FEWEST:
        return []
    trees = "1 corrected tree" if corrected == 1 else f"{corrected} corrected trees"
    return [
        f"note: {trees}, fewer than {FEWEST}, is little: none is held out, so the table does not "
        "tell how well the network does on scans like yours"
    ]


def _trained(training: Training, net: nn.Module, watch: Watch[Any], say: Say) -> nn.Module:
    """The network after all steps."""
    done = steps_done(training)
    if done:
        say(f"{training.folder}: going on after step {done} of {training.steps.steps}")
    return train(training, net, watch)


def _compared(course: Course, examples: list[Path]) -> dict[str, Figures]:
    """The figures of the network made, and of the shipped one."""
    networks = {"now": course.weights, "shipped": course.learner.shipped}
    return {name: course.learner.figures(path, examples) for name, path in networks.items()}


def _lines(tables: dict[str, dict[str, Figures]], course: Course) -> list[str]:
    """What to say of a training."""
    lines = list[str]()
    for name, columns in tables.items():
        lines += [f"{name} trees that were held out:", "", *course.learner.table(columns), ""]
    drawn = course.folder / PICTURE
    return [*lines, f"weights written to {course.weights}, losses drawn in {drawn}"]
