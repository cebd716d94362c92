"""`labels.jsonl`: reading gives back what was written, whatever happened in between."""

from pathlib import Path

import pytest

from prunus.errors import PrunusError
from prunus.io.labels import EdgeLabel, LabelHead, append_label, labels_in, read_labels

HEAD = LabelHead(
    input={"file": "tree.ply", "sha256": "ab", "points": 3},
    params={"search": {"score": "learned"}},
    seed=0,
    frame="z-up",
    version_of_prunus="1",
)


def label(i: int, valid: bool | None = True, category: str | None = None) -> EdgeLabel:
    xyz = ((0.0, 0.0, 0.1 * i), (0.0, 0.0, 0.1 * i + 0.1))
    return EdgeLabel(edge=(i, i + 1), xyz=xyz, valid=valid, category=category)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "tree" / "labels.jsonl"


def test_reading_gives_back_what_was_written(path: Path) -> None:
    written = [label(0, True, "trunk"), label(1, False), label(2, True)]
    for one in written:
        append_label(path, HEAD, one)
    found = read_labels(path)
    assert (found.head, found.labels) == (HEAD, written)
    assert len(path.read_text().splitlines()) == 4


def test_the_last_word_on_an_edge_counts_and_none_takes_it_back(path: Path) -> None:
    for one in (label(0), label(1), label(0, False), label(1, None), label(2, None)):
        append_label(path, HEAD, one)
    assert read_labels(path).labels == [label(0, False)]


def test_a_torn_last_line_is_dropped_and_written_over(path: Path) -> None:
    append_label(path, HEAD, label(0))
    with path.open("a") as file:
        file.write('{"at": "2026-01-01T00:00:00Z", "edge": [1, 2')
    assert read_labels(path).labels == [label(0)]
    append_label(path, HEAD, label(3))
    assert read_labels(path).labels == [label(0), label(3)]


def test_a_file_torn_in_its_head_is_begun_again(path: Path) -> None:
    path.parent.mkdir()
    path.write_text('{"format": "prunus-edge')
    with pytest.raises(PrunusError, match="no whole line"):
        read_labels(path)
    append_label(path, HEAD, label(0))
    assert read_labels(path).labels == [label(0)]


def test_labels_of_another_graph_are_not_mixed(path: Path) -> None:
    append_label(path, HEAD, label(0))
    append_label(path, HEAD.model_copy(update={"version_of_prunus": "2"}), label(1))
    with pytest.raises(PrunusError, match=r"another graph \(seed differs"):
        append_label(path, HEAD.model_copy(update={"seed": 1}), label(2))
    assert read_labels(path).labels == [label(0), label(1)]


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("nonsense", "line 2: not JSON"),
        ("[1, 2]", "line 2: list; expected an object"),
        ('{"edge": [1, 2], "valid": true}', "line 2: xyz: missing"),
        ('{"edge": [2, 1], "xyz": [[0,0,0],[0,0,1]], "valid": true}', "expected .i, j."),
        ('{"edge": [1, 2], "xyz": [[0,0,0],[0,0,1]], "valid": true, "category": "root"}', "categ"),
        (
            '{"edge": [1, 2], "xyz": [[0,0,0],[0,0,1]], "valid": false, "category": "leader"}',
            "not valid",
        ),
        ('{"edge": [1, 2], "xyz": [[0,0,0],[0,0,1]], "valid": true, "who": 1}', "line 2: who"),
    ],
)
def test_what_is_wrong_names_file_and_line(path: Path, line: str, says: str) -> None:
    append_label(path, HEAD, label(0))
    head = path.read_text().splitlines()[0]
    path.write_text(f"{head}\n{line}\n")
    with pytest.raises(PrunusError, match=says) as caught:
        read_labels(path)
    assert str(path) in str(caught.value)


def test_a_folder_lists_its_label_files_by_name(path: Path) -> None:
    append_label(path, HEAD, label(0))
    root = path.parents[1]
    append_label(root / "another" / "labels.jsonl", HEAD, label(0))
    assert labels_in(root) == [root / "another" / "labels.jsonl", path]
    assert labels_in(path.parent) == [path]
    path.write_bytes(path.read_bytes()[:20])
    assert labels_in(path.parent) == [], "it was never begun"
