"""What a journal was begun on is kept beside it: it outlives the chain, and a broken file."""

import json
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prunus.editing import Rebuild, RemoveBranch, Search, SetStatus
from prunus.errors import PrunusError
from prunus.field.voxels import voxels_of
from prunus.frames import scan as intake
from prunus.frames.stance import Stance
from prunus.growth import chain as grown
from prunus.io.arrays import read_arrays, write_arrays
from prunus.model import PointCloud, Skeleton
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.result import Result
from prunus.session import Work
from prunus.session.graphfile import read_graph, rows_of, write_graph
from prunus.session.graphs import Graphs
from prunus.session.sources import superpoints_digest
from tests.conftest import field_scan
from tests.session.conftest import QUICK
from tests.session.test_work import acted, half_of_the_scan, same_state, some_leader


def same(one: Any, other: Any) -> bool:
    """Whether two values are alike bit by bit, down to their arrays."""
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=one.dtype == float)
    if hasattr(one, "__dataclass_fields__"):
        return all(same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    return bool(one == other)


@pytest.fixture(scope="module")
def raw() -> Result:
    """What the machine makes of a raw scan with points that stand twice."""
    xyz = field_scan(4).cloud().sample(20_000, np.random.default_rng(0)).xyz
    cloud = PointCloud.from_xyz(np.concatenate([xyz[::7], xyz, xyz[:500]]))
    return skeletonize(cloud, params=Parameters().changed("isolation", isolate="always"))


@pytest.fixture
def another_chain(monkeypatch: pytest.MonkeyPatch) -> None:
    """From when it is asked for on, the chain finds other nodes."""
    monkeypatch.setattr(grown, "voxels_of", partial(voxels_of, size=0.025))


def files(folder: Path) -> dict[str, bytes]:
    """What counts of a work folder."""
    names = ("journal.jsonl", "skeleton.json", "corrected.json", "mask.ply")
    return {name: (folder / name).read_bytes() for name in names if (folder / name).exists()}


def test_what_was_written_is_read(raw: Result, tmp_path: Path) -> None:
    assert raw.isolated is not None
    write_graph(tmp_path / "graph.npz", raw)
    again = read_graph(tmp_path / "graph.npz").result(raw.scan, raw.params, raw.seed)
    assert len(raw.scan) > len(raw.graph.superpoints.cloud)
    for name in ("in_house", "isolated", "score", "history", "warnings", "notes", "scan", "seed"):
        assert same(getattr(again, name), getattr(raw, name)), name
    assert same(again.graph, raw.graph)


def test_a_graph_of_balls_keeps_no_points_and_finds_them_again(tmp_path: Path) -> None:
    cloud = field_scan(4).target_cloud().sample(8000, np.random.default_rng(0))
    found = skeletonize(cloud, params=Parameters.paper().changed("search", K=20))
    write_graph(tmp_path / "graph.npz", found)
    assert "members" not in read_arrays(tmp_path / "graph.npz")[0]
    again = read_graph(tmp_path / "graph.npz").result(found.scan, found.params, found.seed)
    assert same(again.graph, found.graph)


@pytest.mark.parametrize("seed", range(3))
def test_rows_are_found_again_where_points_stand_twice(seed: int) -> None:
    rng = np.random.default_rng(seed)
    whole = rng.integers(0, 6, (400, 3)).astype(float)
    part = whole[np.sort(rng.choice(400, 90, replace=False))]
    assert (whole[rows_of(part, whole)] == part).all()


def test_a_journal_outlives_the_chain_that_it_was_begun_on(
    scan_file: Path, folder: Path, opened: Work, request: pytest.FixtureRequest
) -> None:
    rng = np.random.default_rng(5)
    opened.do(RemoveBranch(some_leader(opened)))
    acted(opened, rng, 4)
    opened.do(Search())
    opened.do(half_of_the_scan(opened))
    opened.do(Rebuild())
    acted(opened, rng, 4)
    opened.close()
    before = files(folder)
    request.getfixturevalue("another_chain")
    with Work.open(scan_file, folder) as again:
        assert same_state(again.state, opened.state)
        assert "those of graph.npz" in " ".join(again.notes)
        assert not any("gives" in note or "run again" in note for note in again.notes)
    assert files(folder) == before


def test_without_what_was_kept_another_chain_is_told(
    scan_file: Path, folder: Path, opened: Work, request: pytest.FixtureRequest
) -> None:
    opened.do(SetStatus(True))
    opened.close()
    (folder / "graph.npz").unlink()
    request.getfixturevalue("another_chain")
    with pytest.raises(PrunusError, match=":1: was made on other superpoints"):
        Work.open(scan_file, folder)


def test_without_the_rebuilt_graph_another_chain_is_told(
    scan_file: Path, folder: Path, opened: Work, request: pytest.FixtureRequest
) -> None:
    opened.do(half_of_the_scan(opened))
    opened.do(Rebuild())
    opened.close()
    (folder / "graph-3.npz").unlink()
    request.getfixturevalue("another_chain")
    with pytest.raises(PrunusError, match=":3: the chain now gives other superpoints"):
        Work.open(scan_file, folder)


def test_a_tree_built_again_is_built_by_the_chain_of_now(
    scan_file: Path, folder: Path, opened: Work, request: pytest.FixtureRequest
) -> None:
    opened.do(SetStatus(True))
    opened.close()
    request.getfixturevalue("another_chain")
    with Work.open(scan_file, folder) as again:
        kept = superpoints_digest(again.state.result)
        assert superpoints_digest(again.do(Rebuild()).result) != kept
    assert (folder / "graph-3.npz").exists()


def test_the_chain_is_not_run_where_all_is_kept(
    scan_file: Path, folder: Path, opened: Work, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object) -> Result:
        raise AssertionError("the chain was run")

    opened.do(Rebuild())
    opened.do(SetStatus(True))
    opened.close()
    monkeypatch.setattr("prunus.session.sources.skeletonize", never)
    monkeypatch.setattr("prunus.session.history.skeletonize", never)
    with Work.open(scan_file, folder) as again:
        assert same_state(again.state, opened.state)


def test_a_scan_that_is_turned_otherwise_now_stands_as_it_did(
    scan_file: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Work.open(scan_file, folder) as work:
        work.do(RemoveBranch(some_leader(work)))
    before, angle = files(folder), 0.02
    tilt = np.array(
        [[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]]
    )
    monkeypatch.setattr(intake, "find_stance", lambda *_: Stance(frame="z-up", turn=tilt, notes=[]))
    with Work.open(scan_file, folder) as again:
        assert same_state(again.state, work.state)
        assert same(again.scan.cloud, work.scan.cloud)
    assert files(folder) == before


def test_a_journal_of_before_gets_what_it_lacks(
    scan_file: Path, folder: Path, opened: Work
) -> None:
    opened.do(half_of_the_scan(opened))
    opened.do(Rebuild())
    opened.close()
    kept = {path.name: path.read_bytes() for path in folder.glob("graph*")}
    assert set(kept) == {"graph.npz", "graph-3.npz"}
    for name in kept:
        (folder / name).unlink()
    Work.open(scan_file, folder).close()
    assert {path.name: path.read_bytes() for path in folder.glob("graph*")} == kept


def test_what_was_kept_of_another_journal_is_forgotten(
    scan_file: Path, folder: Path, opened: Work
) -> None:
    opened.do(Rebuild())
    opened.close()
    (folder / "journal.jsonl").unlink()
    Work.open(scan_file, folder, QUICK).close()
    assert [path.name for path in folder.glob("graph*")] == ["graph.npz"]


def test_who_only_reads_writes_nothing(scan_file: Path, folder: Path, opened: Work) -> None:
    opened.do(SetStatus(True))
    (folder / "graph.npz").unlink()
    second = Work.open(scan_file, folder, QUICK)
    assert second.read_only is not None
    assert not (folder / "graph.npz").exists()


def broken(content: bytes, how: str) -> bytes:
    """The contents of a file that something has happened to."""
    if how == "empty":
        return b""
    if how == "text":
        return b"this is no graph"
    half = len(content) // 2
    return content[:half] if how == "torn" else content[:half] + b"\x55" * 40 + content[half + 40 :]


@pytest.mark.parametrize("how", ["empty", "text", "torn", "dirty"])
def test_a_broken_file_is_told_and_mended(
    scan_file: Path, folder: Path, opened: Work, how: str
) -> None:
    opened.do(RemoveBranch(some_leader(opened)))
    opened.close()
    path = folder / "graph.npz"
    path.write_bytes(broken(path.read_bytes(), how))
    with Work.open(scan_file, folder) as again:
        assert same_state(again.state, opened.state)
        told = [note for note in again.notes if "the chain was run again" in note]
        assert len(told) == 1 and told[0].startswith(str(path))
    assert Graphs(folder)._file(1) is not None


def test_a_broken_file_and_another_chain_are_told(
    scan_file: Path, folder: Path, opened: Work, request: pytest.FixtureRequest
) -> None:
    opened.do(SetStatus(True))
    opened.close()
    path = folder / "graph.npz"
    torn = broken(path.read_bytes(), "torn")
    path.write_bytes(torn)
    request.getfixturevalue("another_chain")
    with pytest.raises(PrunusError, match=r"other superpoints.*not a readable file of arrays"):
        Work.open(scan_file, folder)
    assert path.read_bytes() == torn


def test_a_graph_of_another_tree_is_passed_over(
    scan_file: Path, folder: Path, opened: Work, raw: Result
) -> None:
    opened.do(SetStatus(True))
    opened.close()
    for other in (raw, opened.state.result):
        write_graph(folder / "graph.npz", other)
        if other is not raw:
            arrays, told = read_arrays(folder / "graph.npz")
            arrays["skeleton_label"][-1] = 0
            write_arrays(folder / "graph.npz", arrays, told)
        with Work.open(scan_file, folder) as again:
            assert same_state(again.state, opened.state)
            assert "the chain was run again" in " ".join(again.notes)


@pytest.mark.parametrize(
    ("name", "change", "says"),
    [
        ("xyz", None, "holds no xyz"),
        ("xyz", lambda a: a * np.nan, "xyz: holds NaN"),
        ("xyz", lambda a: a[:, :2], "xyz: expected superpoints"),
        ("xyz", lambda a: a[:-1], r"expected numbers from 0|held: expected"),
        ("held", lambda a: a[:-1], "held: expected how many"),
        ("members", lambda a: a[:-1], "held: expected how many"),
        ("members", lambda a: a + 99_999, "members: expected numbers"),
        ("steps", lambda a: a + 9_999, "steps: expected numbers from 0"),
        ("steps", lambda a: -a - 1, "steps: expected numbers from 0"),
        ("steps", lambda a: a + 0.5, "steps: expected whole numbers"),
        ("steps", lambda a: a[:0], "points about them"),
        ("edges", lambda a: a[:, ::-1], "edges: expected pairs"),
        ("edges", lambda a: a[::-1], "edges: expected each once"),
        ("edges", lambda a: a + 9_999, "edges: expected numbers from 0"),
        ("confidence", lambda a: a + 2, "confidence: expected numbers from 0 to 1"),
        ("category", lambda a: a[:, :3], "category: of shape"),
        ("tips", lambda a: -a - 1, "tips: expected numbers"),
        ("kind", lambda a: a[:-1], "kind: of shape"),
        ("kind", lambda a: a + 99, "kind: expected numbers"),
        ("skeleton_parent", None, "holds no skeleton_parent"),
        ("skeleton_parent", lambda a: a + 1, "parent"),
        ("skeleton_xyz", lambda a: a[:, :2], r"shape .*; expected \("),
        ("skeleton_label", lambda a: a + 7, "skeleton_label: expected"),
        ("skeleton_superpoint", lambda a: a * 0, "skeleton_superpoint: expected each once"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_file_is_told(
    raw: Result, tmp_path: Path, name: str, change: Any, says: str
) -> None:
    path = tmp_path / "graph.npz"
    write_graph(path, raw)
    arrays, told = read_arrays(path)
    held = arrays.pop(name)
    write_arrays(path, arrays if change is None else arrays | {name: change(held)}, told)
    with pytest.raises(PrunusError, match=says) as raised:
        read_graph(path).result(raw.scan, raw.params, raw.seed)
    assert str(raised.value).startswith(str(path))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"format": "other"}, "told.format"),
        ({"base": 99_999}, "told.base: found 99999"),
        ({"base": -1}, "told.base"),
        ({"points": 3}, "is of 3 points"),
        ({"radius": 0.0}, "told.radius"),
        ({"more": 1}, "told.more"),
        ({"to_house": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}, "expected a rotation"),
    ],
)
def test_what_is_wrong_in_its_words_is_told(
    raw: Result, tmp_path: Path, change: dict[str, object], says: str
) -> None:
    path = tmp_path / "graph.npz"
    write_graph(path, raw)
    arrays, told = read_arrays(path)
    write_arrays(path, arrays, json.dumps(json.loads(told) | change))
    with pytest.raises(PrunusError, match=says):
        read_graph(path).result(raw.scan, raw.params, raw.seed)


def test_no_bytes_lead_to_anything_but_a_message(raw: Result, tmp_path: Path) -> None:
    path, rng = tmp_path / "graph.npz", np.random.default_rng(0)
    write_graph(path, raw)
    content = path.read_bytes()
    for _ in range(150):
        dirty = bytearray(content[: rng.integers(1, len(content) + 1)])
        for place in rng.integers(0, len(dirty), rng.integers(0, 4)):
            dirty[place] = rng.integers(256)
        path.write_bytes(dirty)
        try:
            found = read_graph(path).result(raw.scan, raw.params, raw.seed)
        except PrunusError as error:
            assert str(error).startswith(str(path))
        else:
            assert isinstance(found.in_house, Skeleton)


def test_objects_in_a_file_are_not_called(tmp_path: Path) -> None:
    path = tmp_path / "graph.npz"
    np.savez(path, xyz=np.array([{}], object), told=np.array("{}"))
    with pytest.raises(PrunusError, match="not a readable file of arrays"):
        read_graph(path)
