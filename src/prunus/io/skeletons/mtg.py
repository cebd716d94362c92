"""MTG, the multiscale tree graph of OpenAlea: plant, branches by label, nodes."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from prunus.files.safely import write_bytes
from prunus.io.skeletons.named import names_of
from prunus.model import Label, Skeleton
from prunus.model.branches import Branch, branches, orders

LETTERS = {Label.TRUNK: "T", Label.SUPPORT: "S", Label.LEADER: "L", Label.SIDE_BRANCH: "B"}
"""The classes of branches, at scale 2; P is the plant (1), N a node (3)."""

FEATURES = ("XX", "YY", "ZZ", "Radius", "Confidence")


def write_mtg(path: str | Path, skeleton: Skeleton, named: Mapping[int, str] | None = None) -> None:
    """Write the tree in FORM-A; what is unknown stays blank.

    Branches have the numbers of their names (`named`: see `io.meshes.mesh.tubes`): L3 is leader 3.

    A column further right is what hangs on the node above it. A node lies where its edge ends; the
    base is the first node of the first branch.
    """
    found = branches(skeleton)
    codes = map(_code, found, names_of(skeleton, named or {}))
    starts = {int(branch.rows[1]): code for branch, code in zip(found, codes, strict=True)}
    starts[0] = starts.pop(int(found[0].rows[1]))
    columns = int(orders(found, len(skeleton)).max()) + 2
    entities = [
        "\t" * column + code + "\t" * (columns - column) + values
        for column, code, values in [(0, "/P1", ""), *_entities(skeleton, starts)]
    ]
    head = "ENTITY-CODE" + "\t" * columns + "\t".join(FEATURES)
    write_bytes(Path(path), "\n".join([*_header(), head, *entities, ""]).encode())


def _header() -> list[str]:
    letters = list(LETTERS.values())
    classes = [("$", 0), ("P", 1), *((letter, 2) for letter in letters), ("N", 3)]
    return [
        "CODE:\tFORM-A",
        "\nCLASSES:\nSYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION",
        *(f"{letter}\t{scale}\tFREE\tFREE\tIMPLICIT" for letter, scale in classes),
        "\nDESCRIPTION:\nLEFT\tRIGHT\tRELTYPE\tMAX",
        *(f"{letter}\t{','.join(letters)}\t+\t?" for letter in letters),
        "N\tN\t<\t?",
        "N\tN\t+\t?",
        "\nFEATURES:\nNAME\tTYPE",
        *(f"{name}\tREAL" for name in FEATURES),
        "\nMTG:",
    ]


def _code(branch: Branch, name: str) -> str:
    number = name.rpartition(" ")[2]
    return LETTERS[branch.label] + (number if number.isdecimal() else "1")


def _entities(skeleton: Skeleton, starts: dict[int, str]) -> Iterator[tuple[int, str, str]]:
    """Column, code and values of each branch and node; what hangs on a node follows it at once."""
    below = defaultdict[int, list[int]](list)
    for parent, child in reversed(skeleton.edges.tolist()):
        below[parent].append(child)
    at = {-1: (-1, 0)}
    waiting = [0]
    while waiting:
        row = waiting.pop()
        column, number = at[int(skeleton.parent[row])]
        if row in starts:
            column, number = column + 1, 0
            yield column, f"{'+' if row else '^/'}{starts[row]}", ""
        yield column, f"^{'<' if number else '/'}N{number + 1}", _values(skeleton, row)
        at[row] = column, number + 1
        waiting += sorted(below[row], key=starts.__contains__)


def _values(skeleton: Skeleton, row: int) -> str:
    values = [*skeleton.xyz[row], skeleton.radius[row], skeleton.confidence[row]]
    return "\t".join("" if np.isnan(value) else f"{value:.6f}" for value in values)
