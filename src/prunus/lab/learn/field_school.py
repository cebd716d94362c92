"""`prunus train --network field`: examples, training, weights and a table, in one folder.

recipe.json      what the training is made from; another recipe is refused
examples/        what is learned from; held-out/ what the networks are compared by
checkpoint.pt    from which the same command goes on
log.jsonl        the losses, drawn in losses.html
field.onnx       the weights, and field.json how they were made and how well they do
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from prunus.errors import OptionError, blaming_the_command
from prunus.field.network import SHIPPED
from prunus.field.voxels import Voxels
from prunus.io.safely import digest_of, write_bytes
from prunus.lab.learn.field_examples import FieldExample, lesson_of
from prunus.lab.learn.field_export import field_onnx, parameters_of
from prunus.lab.learn.field_judge import Figures, figures_of, table_of
from prunus.lab.learn.field_losses import PICTURE
from prunus.lab.learn.field_making import Made, examples_to_make, make_examples
from prunus.lab.learn.field_net import FieldNet
from prunus.lab.learn.field_recipe import FieldRecipe, claim
from prunus.lab.learn.field_train import Training, read_checkpoint, steps_done, train_field
from prunus.learn.lessons import Watch
from prunus.names import as_text

WEIGHTS, REPORT = "field.onnx", "field.json"
Say = Callable[[str], None]


@dataclass(frozen=True, kw_only=True)
class FieldCourse:
    """A training of the point field.

    folder: where all of it is kept; start: the network to go on from, `shipped` or a file (.onnx,
    or a checkpoint), None or `scratch` for none; jobs: examples made at the same time.
    """

    folder: Path
    recipe: FieldRecipe
    start: str | None = None
    jobs: int = 1

    @property
    def begins(self) -> Path | None:
        """The file of the network to go on from; OptionError where none is shipped."""
        if self.start in (None, "scratch"):
            return None
        if self.start == "shipped" and not SHIPPED.exists():
            raise OptionError("--from shipped: no network of the point field is shipped yet")
        return SHIPPED if self.start == "shipped" else Path(str(self.start))


def field_school(course: FieldCourse, watch: Watch[Any], say: Say) -> list[str]:
    """Train, or go on with it; writes weights and report. Returns what to say of it.

    PrunusError where the folder holds a training of another recipe.
    """
    recipe, folder, start = course.recipe, course.folder, course.begins
    with blaming_the_command():
        net = begun(start, recipe.seed)
    made_from = {
        "recipe": recipe.model_dump(),
        "from": None if start is None else digest_of(start),
    }
    claim(folder, made_from)
    learned = _made(examples_to_make(folder / "examples", recipe.examples), course.jobs, watch)
    held_out = _made(examples_to_make(folder / "held-out", recipe.held_out), course.jobs, watch)
    training = Training(
        folder=folder,
        simulated=learned,
        steps=recipe.from_scratch if start is None else recipe.going_on,
        seed=recipe.seed,
    )
    net = _trained(training, net, watch, say)
    write_bytes(folder / WEIGHTS, field_onnx(net, _some_voxels(learned[0])))
    tables = {"simulated": _compared(folder / WEIGHTS, held_out)}
    report = {**made_from, "from": start and as_text(start.name), "held_out": tables}
    write_bytes(folder / REPORT, (json.dumps(report, indent=1) + "\n").encode())
    return _lines(tables, folder)


def begun(start: Path | None, seed: int) -> FieldNet:
    """The network as training begins; PrunusError where the file holds none of this kind."""
    torch.manual_seed(seed)
    net = FieldNet()
    if start is None:
        return net
    if start.suffix == ".pt":
        net.load_state_dict(read_checkpoint(start)["net"])
    else:
        net.load_state_dict(parameters_of(start, net))
    return net


def _made(wanted: list[Made], jobs: int, watch: Watch[Any]) -> list[Path]:
    """The files of examples, those made that were missing, without those of too few points."""
    missing = [one for one in wanted if not one.done]
    if missing:
        for _ in watch(make_examples(missing, min(jobs, len(missing))), "examples", len(missing)):
            pass
    return [one.path for one in wanted if one.path.exists()]


def _trained(training: Training, net: FieldNet, watch: Watch[Any], say: Say) -> FieldNet:
    """The network after all steps."""
    done = steps_done(training)
    if done:
        say(f"{training.folder}: going on after step {done} of {training.steps.steps}")
    return train_field(training, net, watch)


def _some_voxels(path: Path) -> Voxels:
    return lesson_of(FieldExample.read(path)).voxels


def _compared(made: Path, examples: list[Path]) -> dict[str, Figures]:
    """The figures of the network made, and of the shipped one, where there is one."""
    networks = {"now": made} | ({"shipped": SHIPPED} if SHIPPED.exists() else {})
    return {name: figures_of(path, examples) for name, path in networks.items()}


def _lines(tables: dict[str, dict[str, Figures]], folder: Path) -> list[str]:
    """What to say of a training."""
    lines = list[str]()
    for name, columns in tables.items():
        lines += [f"{name} trees that were held out:", "", *table_of(columns), ""]
    return [*lines, f"weights written to {folder / WEIGHTS}, losses drawn in {folder / PICTURE}"]
