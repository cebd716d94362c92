"""`prunus params`: the parameters of a method."""

from __future__ import annotations

from typing import Annotated

import typer

from prunus.errors import OptionError


def params(
    ctx: typer.Context,
    method: Annotated[str, typer.Argument(help="default, or paper: as the paper has it.")] = (
        "default"
    ),
) -> None:
    """Print the parameters of a method with symbol, unit and range, as `--params` reads them.

    To change them: `prunus params > mine.toml`

    Those of the paper: `prunus params paper`
    """
    from prunus.params import GROUPS, Parameters

    if method not in GROUPS:
        raise OptionError(f"{method}: no method; expected default or paper")
    ctx.obj.tell(Parameters(method=method).to_toml().splitlines())
