"""MTG: read back by the rules of the format, column by column."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.io.skeletons.mtg import write_mtg
from prunus.model import Label, Skeleton
from tests.drawn import tree
from tests.io.skeletons.test_skeletons import random_skeleton


def read_mtg(path: Path) -> tuple[list[tuple[str, int]], np.ndarray, list[str]]:
    """Of each node its branch's name and the node it hangs on (-1), its values, and the symbols.

    An entity in a column further right hangs (+) on the last node of the column to its left; one
    behind ^ goes on where its column stands.
    """
    head, body = path.read_text().split("MTG:\n")
    lines = body.splitlines()
    columns = lines[0].split("XX")[0].count("\t")
    last: dict[int, int] = {}
    branch: dict[int, str] = {}
    nodes, values = [], []
    for line in lines[1:]:
        column = len(line) - len(line.lstrip("\t"))
        code = line.split()[0]
        if code.lstrip("^/<+")[0] != "N":
            branch[column] = code.lstrip("^/+")
            continue
        hangs_on = last[column] if code[1] == "<" else last.get(column - 1, -1)
        nodes.append((branch[column], hangs_on))
        values.append([float(word or "nan") for word in line.split("\t")[columns:]])
        last[column] = len(nodes) - 1
    return nodes, np.array(values), head.split()


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_mtg_holds_the_tree(tmp_path_factory: pytest.TempPathFactory, seed: int) -> None:
    skeleton = random_skeleton(seed)
    if len(skeleton) == 1:
        return
    path = tmp_path_factory.mktemp("mtg") / "t.mtg"
    write_mtg(path, skeleton)
    nodes, values, _ = read_mtg(path)
    assert len(nodes) == len(skeleton)
    assert edges_of(values[:, :3], [above for _, above in nodes]) == edges_of(
        skeleton.xyz.round(6), skeleton.parent.tolist()
    )
    order = np.lexsort(values[:, :3].T), np.lexsort(skeleton.xyz.round(6).T)
    assert values[order[0], 3] == pytest.approx(skeleton.radius[order[1]], abs=1e-6, nan_ok=True)


def edges_of(xyz: np.ndarray, parent: list[int]) -> set[tuple[float, ...]]:
    return {(*xyz[row], *xyz[above]) for row, above in enumerate(parent) if above >= 0}


def test_branches_are_of_the_class_of_their_label(tmp_path: Path) -> None:
    write_mtg(tmp_path / "t.mtg", tree())
    nodes, values, words = read_mtg(tmp_path / "t.mtg")
    assert {name for name, _ in nodes} == {"T1", "S1", "S2", "L1", "L2", "L3", "B1"}
    assert nodes[0] == ("T1", -1)
    assert words[:2] == ["CODE:", "FORM-A"]
    assert [words[words.index(letter) + 1] for letter in "PTSLBN"] == list("122223")
    leader = [v for (name, _), v in zip(nodes, values, strict=True) if name.startswith("L")]
    assert len(leader) == int((tree().label == Label.LEADER).sum())


def test_no_number_has_a_sign_that_mtg_takes_for_an_edge(tmp_path: Path) -> None:
    far = Skeleton.build([(1e7, -1e7, 1e-9), (1e7, -1e7, 1.0)], [-1, 0], [0, 0])
    write_mtg(tmp_path / "t.mtg", far)
    assert "e" not in (tmp_path / "t.mtg").read_text().split("Confidence\n")[-1]
