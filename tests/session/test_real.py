"""The real scan as it was corrected on the page: what it came to, and that it does so again."""

from collections.abc import Iterator
from pathlib import Path
from shutil import copyfile

import pytest

from prunus.editing import Mark, SetStatus
from prunus.editing.edits import edits
from prunus.lab.evaluate.pairs import compare
from prunus.model import Kind, Label
from prunus.model.branches import branches
from prunus.model.leaders import leaders
from prunus.rules import offenders
from prunus.session import Work, status_of
from prunus.session.history import gives
from prunus.session.journal import read_journal

JOURNAL = Path(__file__).parents[1] / "data" / "ufo_tree0.journal.jsonl"
GRAPH = JOURNAL.with_name("ufo_tree0.graph.npz")
"""What the default of 0.1, which is gone, had made of the scan."""


@pytest.fixture(scope="module")
def corrected(real_scan: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Work]:
    """The tree with all that was done to it, on the graph of 0.1 that it was begun on."""
    folder = tmp_path_factory.mktemp("real")
    copyfile(JOURNAL, folder / "journal.jsonl")
    copyfile(GRAPH, folder / "graph.npz")
    with Work.open(real_scan, folder) as work:
        yield work


def test_the_journal_names_no_place_of_the_machine_that_it_was_made_on() -> None:
    text = JOURNAL.read_text()
    journal = read_journal(JOURNAL)
    assert journal is not None and journal.head.input.file == "ufo_tree0.ply"
    assert not any(root in text for root in ('"/', "\\\\", "file:", "/home", "/tmp"))


def test_every_act_gives_what_it_gave(corrected: Work) -> None:
    journal = read_journal(JOURNAL)
    assert journal is not None
    assert not [note for note in corrected.notes if "journal.jsonl" in note]
    last = journal.lines[-1]
    assert last.gives == gives(last.move, corrected.state)
    assert isinstance(last.move, SetStatus) and status_of(corrected.folder) == "done"


def test_the_real_tree_is_a_legal_one_of_a_trunk_two_supports_and_five_leaders(
    corrected: Work,
) -> None:
    skeleton = corrected.state.draft.skeleton()
    assert not offenders(skeleton)
    assert len(leaders(skeleton)) == 5
    found = [len(branches(skeleton, label)) for label in Label]
    assert found == [1, 2, 5, 14]
    left, right = sorted(
        (branch.length for branch in branches(skeleton, Label.SUPPORT)), reverse=True
    )
    assert left == pytest.approx(1.72, abs=0.01) and right == pytest.approx(0.35, abs=0.01)


def test_a_fifth_of_the_edges_had_to_be_corrected(corrected: Work) -> None:
    needed = edits(corrected.machine, corrected.state.draft.numbered())
    assert (needed.wrong, needed.missing, needed.mislabelled) == (13, 11, 9)
    assert needed.ratio == pytest.approx(0.213, abs=0.001)
    told = compare("real", corrected.folder / "skeleton.json", corrected.folder / "corrected.json")
    assert told["edit_ratio"] == pytest.approx(needed.ratio)


def test_wires_and_a_neighbour_that_were_marked_are_no_longer_the_tree(corrected: Work) -> None:
    marks = [act for act in corrected.acts if isinstance(act, Mark)]
    assert [act.kind for act in marks] == [Kind.WIRE, Kind.WIRE, Kind.WIRE, Kind.NEIGHBOUR]
    assert int((corrected.state.kind == Kind.TARGET).sum()) == 12_592
    assert (corrected.folder / "mask.ply").exists()
