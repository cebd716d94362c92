"""The command line as a person and a script use it: outputs, messages, exit status."""

import csv
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from typer.testing import CliRunner, Result

import prunus as prunus_package
from prunus.cli import app
from prunus.io.clouds.cloud_file import read_cloud, write_cloud
from prunus.io.ply import read_ply
from prunus.io.skeletons.skeleton_file import read_record, read_skeleton, write_skeleton
from prunus.lab.simulate.orchard import simulate_tree
from prunus.params import Parameters
from prunus.rules import offenders
from prunus.schemas import schema
from tests.conftest import simulated
from tests.drawn import tree
from tests.recordings import Recording
from tests.recordings import table_of as points_table

OUTPUTS = {
    "skeleton.json", "skeleton.swc", "skeleton.ply", "refined.json", "params.toml", "report.html",
}  # fmt: skip
FAST = ["--no-report", "--frame", "z-up"]


def prunus(*words: object) -> Result:
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    """A small simulated scan as a PLY file; its base is the origin."""
    truth, cloud = simulated(2)
    write_cloud(tmp_path / "tree.ply", cloud.to_input.apply(cloud.xyz) - truth.xyz[0])
    return tmp_path / "tree.ply"


@pytest.fixture
def quick(tmp_path: Path) -> Path:
    """Parameters that make the chain quick."""
    (tmp_path / "quick.toml").write_text("[input]\npoints = 20000\n")
    return tmp_path / "quick.toml"


def test_one_tree_gives_all_its_files(scan: Path, quick: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    base = ["--base", "0", "0", "0"]
    done = prunus("skeletonize", scan, "-o", out, *base, "--params", quick)
    assert done.exit_code == 0, done.output
    assert {path.name for path in out.iterdir()} == OUTPUTS
    skeleton, record = read_record(out / "skeleton.json")
    assert not {"label_progression", "one_trunk_at_base"} & set(offenders(skeleton))
    assert record.input is not None and record.input.file == "tree.ply"
    assert record.params is not None and record.params["input"]["points"] == 20_000
    assert np.linalg.norm(skeleton.xyz[0]) < 0.15
    assert "leaders" in done.stdout


def test_the_refined_tree_has_the_same_superpoints_and_the_radii(
    scan: Path, quick: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    assert prunus("skeletonize", scan, "-o", out, "--params", quick, *FAST).exit_code == 0
    coarse, fine = (read_skeleton(out / f"{name}.json") for name in ("skeleton", "refined"))
    assert len(fine) > len(coarse)
    assert not {"label_progression", "one_trunk_at_base"} & set(offenders(fine))
    stands = {int(node): row for row, node in enumerate(fine.superpoint) if node >= 0}
    assert sorted(stands) == sorted(coarse.superpoint.tolist())
    rows = [stands[int(node)] for node in coarse.superpoint]
    assert np.array_equal(coarse.radius, fine.radius[rows], equal_nan=True)
    assert np.isfinite(coarse.radius).mean() > 0.8
    assert np.median(np.linalg.norm(coarse.xyz - fine.xyz[rows], axis=1)) < 0.05


def test_traits_have_a_row_a_branch(
    scan: Path, quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    out = tmp_path / "out"
    done = prunus("skeletonize", scan, "-o", out, "--params", quick, "--traits", "--json", *FAST)
    assert done.exit_code == 0, done.output
    record = json.loads(done.stdout)
    with (out / "traits.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len([row for row in rows if row["label"] == "leader"]) == record["leaders"]
    assert {row["tree"] for row in rows} == {"tree.ply"}
    with (out / "tree_traits.csv").open() as file:
        (tree,) = csv.DictReader(file)
    assert int(tree["leaders"]) == record["leaders"]
    assert not (out / "traits.parquet").exists()
    wanted = "traits.parquet was not written: Parquet needs pyarrow: pip install 'prunus[tables]'"
    assert wanted in record["warnings"]


def test_the_method_of_the_paper_goes_by_its_name(scan: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    base = ["--base", "0", "0", "0"]
    done = prunus("skeletonize", scan, "-o", out, *base, "--params", "paper", *FAST)
    assert done.exit_code == 0, done.output
    assert Parameters.from_toml(out / "params.toml") == Parameters.paper()


def test_the_same_run_gives_the_same_bytes(scan: Path, quick: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert prunus("skeletonize", scan, "-o", tmp_path / name, "--params", quick).exit_code == 0
    for name in OUTPUTS - {"report.html"}:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name


def test_what_an_older_run_wrote_is_not_left_beside_another_tree(
    scan: Path, quick: Path, tmp_path: Path
) -> None:
    out, by_hand = tmp_path / "out", {"corrected.json", "journal.jsonl", "mine.txt"}
    words = ["skeletonize", scan, "-o", out, "--params", quick, "--frame", "z-up"]
    assert prunus(*words, "--traits").exit_code == 0
    assert prunus("cuts", out / "skeleton.json", "-o", out / "plan.json").exit_code == 0
    for name in by_hand:
        (out / name).write_text("of a person")
    assert prunus(*words).exit_code == 0
    same_tree = {path.name for path in out.iterdir()}
    assert same_tree == OUTPUTS | by_hand | {"plan.json"}
    assert prunus(*words, "--no-report", "--points", 8000).exit_code == 0
    assert {path.name for path in out.iterdir()} == OUTPUTS - {"report.html"} | by_hand


def test_the_plan_of_a_corrected_tree_stays(scan: Path, quick: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    write_skeleton(tmp_path / "corrected.json", tree())
    out.mkdir()
    planned = prunus("cuts", tmp_path / "corrected.json", "-o", out / "plan.json")
    assert planned.exit_code == 0, planned.output
    for _ in range(2):
        done = prunus("skeletonize", scan, "-o", out, "--params", quick, *FAST)
        assert done.exit_code == 0 and (out / "plan.json").exists()


def test_json_prints_one_line_a_tree_and_nothing_else(
    scan: Path, quick: Path, tmp_path: Path
) -> None:
    bad = tmp_path / "bad.xyz"
    bad.write_text("1 2\n")
    done = prunus(
        "skeletonize", scan, bad, "-o", tmp_path / "out", "--json", "--params", quick, *FAST
    )
    assert done.exit_code == 1
    records = {Path(r["file"]).name: r for r in map(json.loads, done.stdout.splitlines())}
    good, failed = records["tree.ply"], records["bad.xyz"]
    for record in records.values():
        jsonschema.validate(record, schema("skeletonize"))
    assert good["edges"] == sum(good["labels"].values()) < good["candidates"]
    assert good["ok"] and good["error"] is None
    assert good["cpu_s"]["total"] == pytest.approx(
        sum(s for stage, s in good["cpu_s"].items() if stage != "total"), abs=1e-3
    )
    assert not failed["ok"] and "rows hold 2 numbers" in failed["error"]
    assert read_skeleton(good["skeleton"]) is not None
    assert (tmp_path / "out" / "tree" / "skeleton.json").exists()


def test_a_folder_goes_on_past_a_bad_file_and_says_so(
    scan: Path, quick: Path, tmp_path: Path
) -> None:
    (tmp_path / "empty.ply").write_bytes(b"")
    done = prunus("skeletonize", tmp_path, "-o", tmp_path / "out", "--params", quick, *FAST)
    assert done.exit_code == 1
    assert "1 of 2 failed" in done.stderr
    assert "empty.ply: the file is empty" in done.stderr
    assert (tmp_path / "out" / "tree" / "skeleton.json").exists()


@pytest.mark.slow
def test_two_jobs_do_the_same(scan: Path, quick: Path, tmp_path: Path) -> None:
    (tmp_path / "again.ply").write_bytes(scan.read_bytes())
    words = ["skeletonize", scan, tmp_path / "again.ply", "--params", quick, *FAST]
    assert prunus(*words, "-o", tmp_path / "one").exit_code == 0
    assert prunus(*words, "-o", tmp_path / "two", "--jobs", 2).exit_code == 0
    for name in ("tree", "again"):
        one, two = (tmp_path / jobs / name / "skeleton.swc" for jobs in ("one", "two"))
        assert one.read_bytes() == two.read_bytes()


def test_inputs_of_one_name_are_refused_not_overwritten(
    scan: Path, quick: Path, tmp_path: Path
) -> None:
    twin = tmp_path / "tree.pcd"
    twin.write_bytes(b"no cloud")
    done = prunus("skeletonize", scan, twin, "-o", tmp_path / "out", "--params", quick, *FAST)
    assert done.exit_code == 1
    assert "both would be written to" in done.stderr


def test_inputs_of_one_name_in_two_folders_go_by_their_folders(
    scan: Path, quick: Path, tmp_path: Path
) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "tree.ply").write_bytes(scan.read_bytes())
    words = [tmp_path / "a" / "tree.ply", tmp_path / "b" / "tree.ply", "-o", tmp_path / "out"]
    assert prunus("skeletonize", *words, "--params", quick, *FAST).exit_code == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"a", "b"}


def test_the_folders_of_the_data_set_are_inputs(scan: Path, quick: Path, tmp_path: Path) -> None:
    for name in ("bag_0", "bag_1"):
        (tmp_path / "set" / name).mkdir(parents=True)
        (tmp_path / "set" / name / "cloud_final.ply").write_bytes(scan.read_bytes())
        (tmp_path / "set" / name / "top_cloud.ply").write_bytes(b"no cloud")
    out = tmp_path / "out"
    rest = ["--params", quick, *FAST]
    assert prunus("skeletonize", tmp_path / "set", "-o", out, *rest).exit_code == 0
    assert {path.name for path in out.iterdir()} == {"bag_0", "bag_1"}
    one = tmp_path / "one"
    assert prunus("skeletonize", tmp_path / "set" / "bag_1", "-o", one, *rest).exit_code == 0
    for name in ("skeleton.swc", "skeleton.ply"):
        assert (one / name).read_bytes() == (out / "bag_1" / name).read_bytes()
    assert prunus("convert", tmp_path / "set" / "bag_1", tmp_path / "t.xyz").exit_code == 0


@pytest.mark.parametrize("kind", ["ros1", "sqlite3", "mcap"])
def test_a_bag_is_an_input_like_any_other(
    kind: str, scan: Path, quick: Path, tmp_path: Path
) -> None:
    pytest.importorskip("rosbags")
    recording = Recording(kind)
    recording.cloud("/left/points", points_table(read_cloud(scan).xyz))
    recording.cloud("/right/points", points_table(np.zeros((5, 3))))
    bag, out = recording.write(tmp_path), tmp_path / "out"
    done = prunus("skeletonize", bag, "-o", out, "--params", quick, *FAST)
    assert done.exit_code == 1 and not out.exists()
    assert "2 topics hold point clouds" in done.stderr and "Traceback" not in done.output
    topic = f"{bag}#/left/points"
    done = prunus("skeletonize", topic, "-o", out, "--json", "--params", quick, *FAST)
    assert done.exit_code == 0, done.output
    record = json.loads(done.stdout)
    assert record["file"] == topic and record["points"] == 20_000
    assert "topic /left/points: 1 message joined" in record["warnings"]
    written = read_record(out / "skeleton.json")[1].input
    assert written is not None and written.file == f"{bag.name}#/left/points"
    assert prunus("convert", topic, tmp_path / "t.xyz").exit_code == 0
    done = prunus("convert", bag, tmp_path / "t.xyz")
    assert done.exit_code == 1 and "2 topics hold point clouds" in done.stderr


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["none.ply"], 1, "none.ply: cannot be read (No such file"),
        (["tree.ply", "--base", "9", "9", "9"], 1, "from the nearest wood"),
        (["tree.ply", "--params", "typo.toml"], 2, "input.k: unknown parameter"),
        (["tree.ply", "--params", "none.toml"], 2, "none.toml: cannot be read"),
        (["tree.ply", "--points", "few"], 2, "--points: 'few'; expected a number or 'all'"),
        (["tree.ply", "--points", "0"], 2, "input.points"),
        (["tree.ply", "--frame", "sideways"], 2, "Invalid value for '--frame'"),
        (["tree.ply", "--seed", "-1"], 2, "Invalid value for '--seed'"),
        (["tree.ply", "--nonsense"], 2, "No such option"),
        (["hollow"], 1, "no point cloud in this folder"),
        (["tree.ply", "-o", "typo.toml"], 1, "typo.toml: is a file; expected a folder"),
        (["pieces.xyz", "--base", "1.5", "0", "0"], 1, "m from the nearest wood"),
    ],
)
def test_bad_input_gets_one_clear_line_and_a_status(
    scan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    words: list[str], status: int, message: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    (tmp_path / "typo.toml").write_text("[input]\nk = 5\n")
    (tmp_path / "hollow").mkdir()
    flat = np.random.default_rng(0).uniform(0, 0.05, (400, 3))
    np.savetxt(tmp_path / "pieces.xyz", np.concatenate([flat, flat + np.array([3, 0, 0])]))
    done = prunus("skeletonize", *words)
    assert done.exit_code == status, done.output
    assert message in done.stderr.replace("\n", " ")
    assert "Traceback" not in done.output
    assert not list(tmp_path.rglob("skeleton.json"))


def test_a_full_disk_leaves_nothing_half_written(
    scan: Path, quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import errno
    import os

    def full(descriptor: int, mode: str) -> None:
        os.close(descriptor)
        raise OSError(errno.ENOSPC, "No space left on device")

    out = tmp_path / "out"
    monkeypatch.setattr("prunus.files.safely.os.fdopen", full)
    done = prunus("skeletonize", scan, "-o", out, "--params", quick, *FAST)
    assert done.exit_code == 1
    assert "cannot be written (No space left on device)" in done.stderr
    assert list(out.iterdir()) == []


def test_an_unwritable_folder_is_named(scan: Path, quick: Path) -> None:
    done = prunus("skeletonize", scan, "-o", "/proc/nowhere", "--params", quick, *FAST)
    assert done.exit_code == 1
    assert "/proc/nowhere" in done.stderr and "cannot be written" in done.stderr


def test_the_demo_shows_what_was_found(tmp_path: Path) -> None:
    done = prunus("demo", "-o", tmp_path / "demo", "--seed", 3)
    assert done.exit_code == 0, done.output
    assert {path.name for path in (tmp_path / "demo").iterdir()} == OUTPUTS | {
        "scan.ply", "truth.json",
    }  # fmt: skip
    assert "against the truth" in done.stdout


@pytest.mark.parametrize("ending", [".swc", ".ply", ".graphml", ".json"])
def test_skeletons_convert(tmp_path: Path, ending: str) -> None:
    from prunus.io.skeletons.skeleton_file import write_skeleton
    from tests.drawn import tree

    write_skeleton(tmp_path / "s.json", tree(), score=2.5)
    done = prunus("convert", tmp_path / "s.json", tmp_path / f"t{ending}")
    assert done.exit_code == 0, done.output
    assert (tmp_path / f"t{ending}").stat().st_size > 100
    if ending == ".json":
        assert (tmp_path / "t.json").read_bytes() == (tmp_path / "s.json").read_bytes()


ENDINGS = [
    ".glb", ".gltf", ".obj", ".mtg", ".cylinders.csv", ".treeqsm.csv", ".txt", ".mcap",
]  # fmt: skip


@pytest.mark.parametrize("ending", ENDINGS)
def test_skeletons_convert_to_wood_and_what_is_lost_is_said(tmp_path: Path, ending: str) -> None:
    from prunus.io.skeletons.skeleton_file import write_skeleton
    from tests.drawn import tree

    drawn = replace(tree(), superpoint=np.arange(len(tree())))
    write_skeleton(tmp_path / "s.json", drawn)
    done = prunus("convert", tmp_path / "s.json", tmp_path / f"t{ending}")
    assert done.exit_code == 0, done.output
    assert (tmp_path / f"t{ending}").stat().st_size > 100
    left_out = next(line for line in done.stderr.splitlines() if "no place for it" in line)
    assert f"t{ending}: left out" in left_out and "superpoint" in left_out
    unknown = f"the radius is unknown at {len(drawn)} of {len(drawn)} nodes: 5 mm was taken there"
    assert (unknown in done.stderr) == (ending != ".mtg")
    if ending not in (".glb", ".mcap"):
        assert "nan" not in (tmp_path / f"t{ending}").read_text().lower()
    write_skeleton(tmp_path / "base.json", tree("o"))
    done = prunus("convert", tmp_path / "base.json", tmp_path / f"t{ending}")
    assert done.exit_code == 1
    assert "base.json: holds a base alone" in done.stderr


def test_a_cloud_goes_into_a_bag_and_into_nothing_else(scan: Path, tmp_path: Path) -> None:
    from prunus.io.skeletons.skeleton_file import write_skeleton
    from tests.drawn import tree

    write_skeleton(tmp_path / "s.json", tree())
    words = ["convert", tmp_path / "s.json", tmp_path / "t.mcap", "--cloud", scan]
    assert prunus(*words).exit_code == 0
    assert prunus("convert", tmp_path / "t.mcap", tmp_path / "back.xyz").exit_code == 0
    assert len((tmp_path / "back.xyz").read_text().splitlines()) == 20_000
    write_cloud(tmp_path / "utm.ply", np.array([[4e5, 5e6, 1.0], [4e5, 5e6, 2.0]]))
    done = prunus(*words[:-1], tmp_path / "utm.ply", "--unit", "m")
    assert "the points are in single precision: so far from the origin to 500 mm" in done.stderr
    done = prunus("convert", tmp_path / "s.json", tmp_path / "t.glb", "--cloud", scan)
    assert done.exit_code == 2
    assert "t.glb: holds no cloud; expected a bag (.mcap)" in done.stderr


def test_a_skeleton_converted_to_its_own_kind_says_all_that_it_said(tmp_path: Path) -> None:
    said = {
        "score": 1.5,
        "trust": {"tree": 0.9, "edges": [None, *[0.9] * (len(tree()) - 1)], "branches": []},
        "review": ["a reason"],
        "input": {"file": "a.ply", "sha256": "0", "points": 9},
        "params": {},
        "seed": 3,
        "version_of_prunus": "0",
    }
    write_skeleton(tmp_path / "s.json", tree(), **said)
    assert prunus("convert", tmp_path / "s.json", tmp_path / "t.json").exit_code == 0
    assert (tmp_path / "t.json").read_bytes() == (tmp_path / "s.json").read_bytes()
    assert json.loads((tmp_path / "t.json").read_text()).items() >= said.items()


def test_clouds_convert_and_unknown_kinds_do_not(scan: Path, tmp_path: Path) -> None:
    assert prunus("convert", scan, tmp_path / "t.xyz").exit_code == 0
    assert len((tmp_path / "t.xyz").read_text().splitlines()) == 20_000
    for source, target, status, message in [
        (scan, "t.obj", 2, "clouds are not written as '.obj'"),
        ("none.json", "t.swc", 1, "none.json: cannot be read"),
        ("none.swc", "t.doc", 2, "skeletons are not written as '.doc'"),
    ]:
        done = prunus("convert", source, tmp_path / str(target))
        assert done.exit_code == status
        assert message in done.stderr


def test_version_and_help_answer() -> None:
    import prunus as package

    assert prunus("--version").stdout == f"prunus {package.__version__}\n"
    for words in (["--help"], ["skeletonize", "-h"], ["convert", "-h"], ["demo", "-h"]):
        assert "prunus" in prunus(*words).stdout


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys; sys.argv = ['prunus', '--help']\n"
        "from prunus.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "print('heavy:', sorted({'numpy', 'numba', 'pydantic', 'plotly'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "heavy: []" in done.stdout


@pytest.mark.slow
def test_an_orchard_is_written_tree_by_tree(tmp_path: Path) -> None:
    done = prunus("simulate", "-n", 2, "-o", tmp_path / "orchard", "--seed", 5, "--jobs", 1)
    assert done.exit_code == 0, done.output
    names = [path.name for path in sorted((tmp_path / "orchard").iterdir())]
    assert names == ["tree_000005", "tree_000006"]
    files = {path.name for path in (tmp_path / "orchard" / names[0]).iterdir()}
    assert files == {"scan.ply", "truth.json", "trees.npz"}
    scan, out = tmp_path / "orchard" / names[0] / "scan.ply", tmp_path / "out"
    assert prunus("skeletonize", scan, "-o", out, *FAST).exit_code == 0
    assert prunus("skeletonize", tmp_path / "orchard", "-o", out, *FAST).exit_code == 0
    assert {path.name for path in out.iterdir() if path.is_dir()} == set(names)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ([], "no folder to learn from"),
        (["--recipe", "mine.toml"], "--recipe: of no use with --network edges"),
        (["--network", "field", "--epochs", 3], "stand in its recipe"),
        (["--network", "field", "--seed", 3], "stand in its recipe"),
        (["--network", "field", "--recipe", "mine.toml"], "mine.toml: seed"),
        (["--network", "owner", "--epochs", 3], "stand in its recipe"),
        (["--network", "owner", "--recipe", "mine.toml"], "mine.toml: seed"),
        (["mine.toml", "--network", "owner"], "learns from simulated rows alone"),
    ],
)
def test_a_training_that_cannot_be_meant_blames_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: list[object], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text("seed = -1\n")
    done = prunus("train", "-o", tmp_path / "out", *given)
    assert (done.exit_code, said in done.stderr) == (2, True), done.stderr
    assert not (tmp_path / "out").exists()


def test_training_on_a_folder_without_scans_says_what_it_expects(tmp_path: Path) -> None:
    pytest.importorskip("torch")
    done = prunus("train", tmp_path, "-o", tmp_path / "mine.onnx")
    assert done.exit_code == 1
    assert "no simulated tree in it" in done.output and "prunus simulate" in done.output


def test_weights_that_are_none_fail_with_their_name(scan: Path, tmp_path: Path) -> None:
    (tmp_path / "bad.onnx").write_text("no network")
    words = ["-o", tmp_path / "out", "--weights", tmp_path / "bad.onnx", "--params", "paper"]
    done = prunus("skeletonize", scan, *words)
    assert done.exit_code == 2
    assert "bad.onnx: not an ONNX file" in done.output


def test_parameters_of_the_paper_come_from_a_file(scan: Path, tmp_path: Path) -> None:
    (tmp_path / "paper.toml").write_text('method = "paper"\n[search]\nK = 20\n')
    words = ["-o", tmp_path / "out", *FAST, "--params", tmp_path / "paper.toml"]
    assert prunus("skeletonize", scan, *words).exit_code == 0


@pytest.mark.parametrize("given", ["learned", "old.toml"])
def test_the_method_that_is_gone_is_said_to_be(given: str, scan: Path, tmp_path: Path) -> None:
    (tmp_path / "old.toml").write_text('[search]\nscore = "learned"\n')
    named = tmp_path / given if given.endswith(".toml") else given
    done = prunus("skeletonize", scan, "--params", named)
    assert done.exit_code == 2
    assert "found 'learned', the method of prunus 0.1, which is gone" in done.output.replace(
        "\n", " "
    )


SHIPPED_NET = Path(prunus_package.__file__).parent / "weights" / "paper.onnx"


@pytest.mark.parametrize("command", ["skeletonize", "cuts"])
def test_what_the_method_has_no_use_for_is_refused(
    command: str, scan: Path, tmp_path: Path
) -> None:
    done = prunus(command, scan, "--weights", SHIPPED_NET)
    assert done.exit_code == 2
    assert "--weights: of no use to the method" in done.output.replace("\n", " ")


def test_a_group_of_another_method_is_refused_with_its_method(scan: Path, tmp_path: Path) -> None:
    (tmp_path / "old.toml").write_text("[tips]\nalpha_tip = 0.5\n")
    done = prunus("skeletonize", scan, "--params", tmp_path / "old.toml")
    assert done.exit_code == 2
    assert 'old.toml: the method "default" does not go by [tips]' in done.output.replace("\n", " ")
    assert '[tips] is of method = "paper"' in done.output.replace("\n", " ")


@pytest.fixture(scope="module")
def raw(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulate_tree(tmp_path_factory.mktemp("row"), 500_000, "hard", views=False) / "scan.ply"


def test_one_tree_is_taken_out_of_a_raw_scan(raw: Path, tmp_path: Path) -> None:
    done = prunus("isolate", raw, "-o", tmp_path / "tree.ply", "--frame", "z-up")
    assert done.exit_code == 0
    assert "points are the tree; left out: " in done.stdout
    whole, tree = read_cloud(raw), read_cloud(tmp_path / "tree.ply")
    assert 0.05 * len(whole.xyz) < len(tree.xyz) < 0.5 * len(whole.xyz)
    places = {tuple(point) for point in whole.xyz.tolist()}
    assert {tuple(point) for point in tree.xyz.tolist()} <= places


@pytest.mark.slow
def test_trees_are_listed_and_chosen_and_all_written(raw: Path, tmp_path: Path) -> None:
    listed = prunus("isolate", raw, "--list").stdout.splitlines()
    assert len(listed) > 1
    at = listed[1].split("--at ")[1].split()[:3]
    done = prunus("isolate", raw, "-o", tmp_path / "b.ply", "--at", *at)
    assert done.exit_code == 0
    older = tmp_path / f"t_{len(listed) + 1}.ply"
    older.write_bytes(b"of another scan")
    done = prunus("isolate", raw, "-o", tmp_path / "t.ply", "--all")
    assert done.exit_code == 0 and done.stdout.splitlines()[-1].startswith(f"{older}: was there")
    second = read_cloud(tmp_path / "t_2.ply").xyz
    chosen = {tuple(point) for point in read_cloud(tmp_path / "b.ply").xyz.tolist()}
    assert np.mean([tuple(point) in chosen for point in second.tolist()]) > 0.95


def test_classes_are_written_for_every_point(raw: Path, tmp_path: Path) -> None:
    path = tmp_path / "classes.ply"
    assert prunus("isolate", raw, "-o", path, "--classes").exit_code == 0
    vertex = read_ply(path.read_bytes(), path)["vertex"]
    assert len(vertex) == len(read_cloud(raw).xyz)
    assert set(vertex["kind"]) >= {0, 2, 3}
    assert prunus("isolate", raw, "-o", tmp_path / "x.xyz", "--classes").exit_code == 2


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        ([], 2, "nowhere to write to"),
        (["-o", "t.ply", "--at", "9", "9", "9"], 1, "from the nearest"),
        (["-o", "t.ply", "--all", "--base", "9", "9", "9"], 2, "--at: of one tree"),
    ],
)
def test_isolation_says_what_it_lacks(
    words: list[str], status: int, message: str, raw: Path
) -> None:
    done = prunus("isolate", raw, *words)
    assert done.exit_code == status
    assert message in done.stderr


def test_isolate_takes_points_and_parameters(tmp_path: Path, real_scan: Path) -> None:
    def kept(*words: object) -> bytes:
        done = prunus("isolate", real_scan, "-o", tmp_path / "tree.ply", *words)
        assert done.exit_code == 0, done.output
        return (tmp_path / "tree.ply").read_bytes()

    mine = tmp_path / "mine.toml"
    mine.write_text("[input]\npoints = 12000\n")
    few = kept("--points", 12_000)
    assert few == kept("--params", mine)
    assert few != kept()
    assert kept("--params", "paper")  # whose chain isolates nothing by itself
