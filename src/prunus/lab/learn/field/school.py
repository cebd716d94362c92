"""`prunus train --network field`: examples, training, weights and a table, in one folder.

recipe.json      what the training is made from; another recipe is refused
examples/        what is learned from; held-out/ what the networks are compared by;
                 corrected/ both, of trees that a person corrected
checkpoint.pt    from which the same command goes on
log.jsonl        the losses, drawn in losses.html
field.onnx       the weights, and field.json how they were made and how well they do
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from prunus.errors import PrunusError, blaming_the_command
from prunus.field.network import SHIPPED
from prunus.field.voxels import Voxels
from prunus.files.safely import digest_of, write_bytes
from prunus.lab.experiment.gold import Corrected
from prunus.lab.learn.edges.lessons import FEWEST, Watch
from prunus.lab.learn.field.corrected import make_corrected
from prunus.lab.learn.field.examples import FieldExample, lesson_of
from prunus.lab.learn.field.export import field_onnx, parameters_of
from prunus.lab.learn.field.judge import Figures, figures_of, table_of
from prunus.lab.learn.field.losses import PICTURE
from prunus.lab.learn.field.making import Made, examples_to_make, make_examples
from prunus.lab.learn.field.net import FieldNet
from prunus.lab.learn.field.recipe import FieldRecipe, claim
from prunus.lab.learn.field.train import Training, read_checkpoint, steps_done, train_field
from prunus.names import as_text

WEIGHTS, REPORT = "field.onnx", "field.json"
DIGITS = 16  # of a digest, enough to know a file by
Say = Callable[[str], None]


@dataclass(frozen=True, kw_only=True)
class FieldCourse:
    """A training of the point field.

    folder: where all of it is kept; corrected: trees that a person corrected; start: the network to
    go on from, `shipped` or a file (.onnx, or a checkpoint), `scratch` for none, None = the shipped
    one where there are corrected trees; jobs: examples made at the same time.
    """

    folder: Path
    recipe: FieldRecipe
    corrected: Sequence[Corrected] = ()
    start: str | None = None
    jobs: int = 1

    @property
    def begins(self) -> Path | None:
        """The file of the network to go on from."""
        start = self.start or ("shipped" if self.corrected else "scratch")
        return {"scratch": None, "shipped": SHIPPED}.get(start, Path(start))

    @property
    def named(self) -> dict[str, Corrected]:
        """The corrected trees by the names of their examples."""
        return {f"{k:03d}-{own.folder.name}": own for k, own in enumerate(self.corrected)}


def field_school(course: FieldCourse, watch: Watch[Any], say: Say) -> list[str]:
    """Train, or go on with it; writes weights and report. Returns what to say of it.

    PrunusError where the folder holds a training of another recipe, or of other trees.
    """
    recipe, folder = course.recipe, course.folder
    with blaming_the_command():
        net = begun(course.begins, recipe.seed)
    made_from = _made_from(course)
    claim(folder, made_from)
    learned = _made(examples_to_make(folder / "examples", recipe.examples), course.jobs, watch)
    held_out = _made(examples_to_make(folder / "held-out", recipe.held_out), course.jobs, watch)
    own, own_held_out = split(_corrected(course, watch))
    training = Training(
        folder=folder,
        simulated=learned,
        corrected=own,
        share=recipe.corrected.share,
        steps=recipe.from_scratch if course.begins is None else recipe.going_on,
        seed=recipe.seed,
    )
    net = _trained(training, net, watch, say)
    write_bytes(folder / WEIGHTS, field_onnx(net, _some_voxels(learned[0])))
    sets = {"simulated": held_out, "corrected": own_held_out}
    tables = {name: _compared(folder / WEIGHTS, paths) for name, paths in sets.items() if paths}
    report = json.dumps(made_from | {"held_out": tables}, indent=1)
    write_bytes(folder / REPORT, f"{report}\n".encode())
    return [*_notes(len(course.corrected)), *_lines(tables, folder)]


def _made_from(course: FieldCourse) -> dict[str, Any]:
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


def begun(start: Path | None, seed: int) -> FieldNet:
    """The network as training begins; PrunusError where the file holds none of this kind."""
    torch.manual_seed(seed)
    net = FieldNet()
    if start is None:
        return net
    held = read_checkpoint(start)["net"] if start.suffix == ".pt" else parameters_of(start, net)
    try:
        net.load_state_dict(held)
    except RuntimeError as error:
        raise PrunusError(f"{start}: a checkpoint of a network of another form") from error
    return net


def _made(wanted: list[Made], jobs: int, watch: Watch[Any]) -> list[Path]:
    """The files of examples, those made that were missing, without those of too few points."""
    missing = [one for one in wanted if not one.done]
    if missing:
        for _ in watch(make_examples(missing, min(jobs, len(missing))), "examples", len(missing)):
            pass
    made = [one.path for one in wanted if one.path.exists()]
    if wanted and not made:
        raise PrunusError(f"{wanted[0].path.parent}: no scan with enough points; expected some")
    return made


def _corrected(course: FieldCourse, watch: Watch[Any]) -> list[Path]:
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


def _trained(training: Training, net: FieldNet, watch: Watch[Any], say: Say) -> FieldNet:
    """The network after all steps."""
    done = steps_done(training)
    if done:
        say(f"{training.folder}: going on after step {done} of {training.steps.steps}")
    return train_field(training, net, watch)


def _some_voxels(path: Path) -> Voxels:
    return lesson_of(FieldExample.read(path)).voxels


def _compared(made: Path, examples: list[Path]) -> dict[str, Figures]:
    """The figures of the network made, and of the shipped one."""
    networks = {"now": made, "shipped": SHIPPED}
    return {name: figures_of(path, examples) for name, path in networks.items()}


def _lines(tables: dict[str, dict[str, Figures]], folder: Path) -> list[str]:
    """What to say of a training."""
    lines = list[str]()
    for name, columns in tables.items():
        lines += [f"{name} trees that were held out:", "", *table_of(columns), ""]
    return [*lines, f"weights written to {folder / WEIGHTS}, losses drawn in {folder / PICTURE}"]
