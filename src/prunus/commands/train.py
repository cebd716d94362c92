"""`prunus train`: learning a network."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prunus.commands.options import CORES, Jobs, Network, Scans, Seed
from prunus.errors import OptionError, blaming_the_command

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def train(
    ctx: typer.Context,
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", help="Weights to write (.onnx); of field and owner a folder."
        ),
    ],
    folders: Annotated[
        list[Path] | None, typer.Argument(help="Simulated scans, or the studio's folders.")
    ] = None,
    network: Annotated[
        Network,
        typer.Option(help="edges: the paper's; field: of points; owner: whose wood is."),
    ] = Network.EDGES,
    start: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="Go on from: paper, shipped (field, owner), a file, scratch. "
            "[default: paper with labels]",
        ),
    ] = None,
    scans: Scans = None,
    seed: Seed = 0,
    epochs: Annotated[int | None, typer.Option(min=1, help="[default: as the recipe]")] = None,
    recipe: Annotated[
        Path | None,
        typer.Option(
            exists=True, dir_okay=False, help="Of field, owner: TOML. [default: the shipped]"
        ),
    ] = None,
    jobs: Jobs = CORES,
) -> None:
    """Learn a network from scans with their truth, and print how well it does.

    From simulated trees: `prunus train orchard -o mine.onnx`

    From edges labelled in the studio: `prunus train prunus-studio -o mine.onnx`

    To use it: `prunus skeletonize tree.ply --weights mine.onnx`

    The point field, again to go on: `prunus train --network field -o run`
    """
    waiting: Waiting = ctx.obj
    if network != Network.EDGES:
        own = f"--network {network.value}"
        if epochs is not None or seed:
            raise OptionError(f"{own}: seed and steps stand in its recipe: see --recipe")
        if folders and network == Network.OWNER:
            raise OptionError(f"{own}: learns from simulated rows alone; expected no folder")
        name = network.value
        waiting.tell(_trained(waiting, name, folders or [], output, recipe, start, scans, jobs))
        return
    if recipe is not None:
        raise OptionError("--recipe: of no use with --network edges; expected field or owner")
    if not folders:
        raise OptionError("no folder to learn from: expected simulated scans, or the studio's")
    waiting.doing("loading torch", at_once=True)
    from prunus.lab.learn.edges.school import Course, lines_of, school

    course = Course(start=start, seed=seed, epochs=epochs, scans=scans)
    waiting.tell(lines_of(school(folders, output, course, jobs, waiting.watch)))


def _trained(
    waiting: Waiting,
    name: str,
    folders: list[Path],
    output: Path,
    recipe: Path | None,
    start: str | None,
    scans: Path | None,
    jobs: int,
) -> list[str]:
    """Train a network on simulated scans, and corrected trees; what to say of it."""
    from prunus.lab.learn.recipe import recipe_of

    with blaming_the_command():
        settings = recipe_of(recipe, name)
    waiting.doing("loading torch", at_once=True)
    try:
        from prunus.lab.learn.learners import LEARNERS
        from prunus.lab.learn.school import Course, school
    except ImportError as error:
        raise OptionError("training needs torch and onnx: pip install 'prunus[train]'") from error
    from prunus.lab.experiment.gold import corrected_in

    corrected = []
    for folder in folders:
        done, in_work = corrected_in(folder, scans)
        corrected += done
        for tree in in_work:
            waiting.say(f"{folder / tree}: not marked as done, so left out")
    course = Course(
        learner=LEARNERS[name], folder=output, recipe=settings, corrected=corrected, start=start,
        jobs=jobs,
    )  # fmt: skip
    return school(course, waiting.watch, waiting.say)
