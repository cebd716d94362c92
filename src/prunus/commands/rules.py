"""`prunus rules`: the shipped pruning rules."""

from __future__ import annotations

import typer


def rules(ctx: typer.Context) -> None:
    """Print the pruning rules that are shipped, as `cuts --rules` reads them.

    To change them: `prunus rules > mine.toml`
    """
    from prunus.cuts.settings import SHIPPED as FILE

    ctx.obj.tell(FILE.read_text(encoding="utf-8").splitlines())
