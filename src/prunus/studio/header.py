"""The lines that are always on the page: which tree, how far it is, whether all is saved."""

from __future__ import annotations

from html import escape
from math import isnan

from prunus.studio.tree import Tree
from prunus.studio.words import block, loud, quiet


def header(tree: Tree) -> str:
    """Name, state, edit distance, and what is wrong with the tree, if anything."""
    name = f'<b style="font-size:15px">{escape(tree.item.name)}</b>'
    if tree.problem is not None:
        return block(name, loud("cannot be opened"), escape(tree.problem))
    state = tree.state
    if state is None:
        doing = "reading" if tree.cloud is None else "looking for the skeleton"
        return block(name, quiet(f"{doing} ..."))
    return block(name, *_work(tree), _edits(tree), *map(quiet, _warnings(tree, first=True)))


def notes(tree: Tree) -> str:
    """How the tree was read and found."""
    before = [f"before your acts: {warning}" for warning in _warnings(tree, first=False)]
    return block(*map(quiet, [*before, *tree.notes]))


def _warnings(tree: Tree, first: bool) -> list[str]:
    """What is wrong with the machine's skeleton: said first until an act stands, then beside."""
    work = tree.work
    if work is None or (work.position == 0) != first:
        return []
    return list(work.state.result.warnings)


def _work(tree: Tree) -> list[str]:
    if tree.read_only is not None:
        return [loud(f"read only: open at {tree.read_only}")]
    assert tree.work is not None
    acts = tree.work.position
    done = "done, " if tree.state is not None and tree.state.done else ""
    return [quiet(f"{done}{acts} act{'' if acts == 1 else 's'}, all saved")]


def _edits(tree: Tree) -> str:
    counts = tree.edits()
    if counts is None:
        return ""
    ratio = "-" if isnan(counts.ratio) else f"{100 * counts.ratio:.1f} %"
    distance = counts.wrong + counts.missing + counts.mislabelled
    return (
        f"edit distance <b>{distance}</b>, ratio <b>{ratio}</b> "
        + quiet(f"({counts.wrong} wrong, {counts.missing} missing, "
                f"{counts.mislabelled} mislabelled of {counts.edges})")
    )  # fmt: skip
