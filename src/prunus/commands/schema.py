"""`prunus schema`: JSON Schemas of what is written."""

from __future__ import annotations

from typing import Annotated

import typer


def schema(
    ctx: typer.Context,
    name: Annotated[str | None, typer.Argument(help="Which one. [default: list them]")] = None,
) -> None:
    """Print the JSON Schema of a file or of a line that prunus writes.

    Which there are: `prunus schema`

    That of `skeletonize --json`: `prunus schema skeletonize`
    """
    from prunus.schemas import ABOUT, text_of

    if name is None:
        ctx.obj.tell(f"{one:<12} {about}" for one, about in ABOUT.items())
    else:
        ctx.obj.tell(text_of(name).splitlines())
