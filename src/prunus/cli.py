"""The command line: a file a command in `commands/`, and what holds for all of them."""

from __future__ import annotations

import os
import sys
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from prunus import __version__
from prunus.commands import (
    convert,
    cuts,
    demo,
    evaluate,
    experiment,
    fuse,
    isolate,
    params,
    rules,
    schema,
    simulate,
    skeletonize,
    studio,
    train,
)
from prunus.errors import PrunusError, Status, describe
from prunus.processes.ending import end_on_signals

COMMANDS = {
    "Trees": (
        skeletonize.skeletonize,
        isolate.isolate,
        cuts.cuts,
        convert.convert,
        fuse.fuse,
        studio.studio,
        demo.demo,
    ),
    "Learning and judging": (
        simulate.simulate,
        train.train,
        evaluate.evaluate,
        experiment.experiment,
    ),
    "What is shipped": (rules.rules, params.params, schema.schema),
}
"""The commands by the heading under which help lists them. Heavy imports are inside of each."""


class Prunus(TyperGroup):
    """All commands: what is wrong is said in a line, and by the exit status."""

    def invoke(self, ctx: Any) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except PrunusError as error:
            ctx.obj.say(f"prunus: {error}")
            raise typer.Exit(Status.of(error)) from None


app = typer.Typer(
    cls=Prunus,
    no_args_is_help=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="""From a 3D point cloud of a dormant fruit tree to a labelled skeleton.

Try it: `prunus demo`

Your own scan: `prunus skeletonize tree.ply -o out`

A folder of scans, two at a time: `prunus skeletonize scans/ -o out --jobs 2`
""",
)
for heading, commands in COMMANDS.items():
    for command in commands:
        app.command(rich_help_panel=heading)(command)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"prunus {__version__}")
        raise typer.Exit


@app.callback()
def _prunus(
    ctx: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Say the version.")
    ] = False,
) -> None:
    """Have every command told of while it is waited for."""
    from prunus.commands.progress import Waiting

    ctx.obj = ctx.with_resource(Waiting())


def main() -> None:
    """Run the command line; a closed pipe and signals end it quietly, any other fault in words."""
    end_on_signals()
    try:
        app()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(Status.FAILED)
    except Exception as error:  # a fault of ours is said in one line, with how to see more of it
        typer.echo(f"prunus: {describe(error)}", err=True)
        sys.exit(Status.FAILED)


if __name__ == "__main__":
    main()
