"""The point field trained on two small scans: resumed, exported, compared; others refused."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

torch = pytest.importorskip("torch", reason="training needs torch: pip install 'prunus[train]'")

from prunus.errors import OptionError, PrunusError  # noqa: E402
from prunus.field.network import SHIPPED as WEIGHTS  # noqa: E402
from prunus.field.network import see_field  # noqa: E402
from prunus.lab.experiment.gold import Corrected  # noqa: E402
from prunus.lab.learn import making, training  # noqa: E402
from prunus.lab.learn.field import corrected as field_corrected  # noqa: E402
from prunus.lab.learn.field import examples as field_examples  # noqa: E402
from prunus.lab.learn.field.examples import FieldExample, lesson_of  # noqa: E402
from prunus.lab.learn.field.lessons import field_losses  # noqa: E402
from prunus.lab.learn.field.net import Tables  # noqa: E402
from prunus.lab.learn.learners import FIELD  # noqa: E402
from prunus.lab.learn.losses import logged  # noqa: E402
from prunus.lab.learn.recipe import FieldRecipe, Steps, recipe_of, shipped_recipe  # noqa: E402
from prunus.lab.learn.school import Course, school, split  # noqa: E402
from prunus.lab.learn.training import Training, read_checkpoint, train  # noqa: E402
from prunus.lab.simulate.scan import Scan  # noqa: E402
from prunus.model import Role  # noqa: E402
from tests.conftest import field_scan  # noqa: E402
from tests.test_cli import prunus  # noqa: E402

FEW = {"wide": 0, "first_wide": 0, "rig": 2, "first_rig": 0, "clean_every": 4}
TINY = recipe_of(None).model_dump() | {
    "examples": FEW,
    "held_out": FEW | {"rig": 1, "first_rig": 9},
    "from_scratch": {"steps": 6, "rate": 2e-3},
    "going_on": {"steps": 2, "rate": 5e-4},
}


def recipe(**changed: Any) -> FieldRecipe:
    return FieldRecipe.model_validate(TINY | changed)


def silently(items: Iterable[Any], name: str, total: int) -> Iterable[Any]:
    return items


def interrupted_after(count: int) -> Callable[..., Iterator[Any]]:
    """Shows progress until the machine dies in the step after so many."""

    def watch(items: Iterable[Any], name: str, total: int) -> Iterator[Any]:
        for number, item in enumerate(items):
            if name.startswith("steps") and number == count:
                raise KeyboardInterrupt
            yield item

    return watch


def course(folder: Path, **changed: Any) -> Course:
    return Course(learner=FIELD, folder=folder, recipe=recipe(**changed))


def make_small(patch: pytest.MonkeyPatch) -> None:
    def scan(seed: int, setting: str) -> Scan:
        return field_scan(3 + seed % 2)

    patch.setattr(making, "simulate_scan", scan)
    patch.setattr(field_examples, "MOST_POINTS", 6000)
    patch.setattr(field_examples, "POINTS", (1000, 2000))
    patch.setattr(training, "KEPT_EVERY", 2)


@pytest.fixture(autouse=True)
def _small_scans(monkeypatch: pytest.MonkeyPatch) -> None:
    make_small(monkeypatch)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A training that is done."""
    path = tmp_path_factory.mktemp("done")
    with pytest.MonkeyPatch.context() as patch:
        make_small(patch)
        lines = school(course(path), silently, str)
    assert any("offset, mm" in line for line in lines)
    return path


def weights_in(folder: Path) -> dict[str, Any]:
    return dict(read_checkpoint(folder / "checkpoint.pt")["net"])


@pytest.mark.slow
def test_an_interrupted_training_ends_as_one_that_was_not(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        school(course(tmp_path), interrupted_after(3), str)
    assert not (tmp_path / "field.onnx").exists()
    said = list[str]()
    school(course(tmp_path), silently, said.append)
    assert said == [f"{tmp_path}: going on after step 2 of 6"]
    whole, resumed = weights_in(folder), weights_in(tmp_path)
    assert all(torch.equal(own, resumed[name]) for name, own in whole.items())
    told = [[(row["step"], row["role"]) for row in logged(one)] for one in (folder, tmp_path)]
    assert told[0] == told[1] and [step for step, _ in told[0]] == [2, 4, 6]


@pytest.mark.slow
def test_the_weights_say_what_the_network_says(folder: Path) -> None:
    example = FieldExample.read(min((folder / "examples").glob("*.npz")))
    voxels = lesson_of(example).voxels
    field = see_field(voxels, folder / "field.onnx")
    net = FIELD.begun(folder / "checkpoint.pt", 0)
    tables = Tables.of(voxels.levels)
    said = net(torch.from_numpy(voxels.features()), tables)[:, : len(Role)].softmax(dim=1)
    assert field.role == pytest.approx(said.detach().numpy(), abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("file", ["field.onnx", "checkpoint.pt"])
def test_training_goes_on_from_weights_in_a_file(folder: Path, file: str) -> None:
    net = FIELD.begun(folder / file, 1)
    assert all(torch.equal(own, net.state_dict()[k]) for k, own in weights_in(folder).items())


def test_corrected_trees_are_learned_from_by_the_shipped_network_unless_said_otherwise() -> None:
    trees = [Corrected(Path("apple"), None)]
    own = Course(learner=FIELD, folder=Path("run"), recipe=recipe(), corrected=trees)
    assert own.begins == WEIGHTS
    assert replace(own, start="scratch").begins is None
    assert replace(own, corrected=[]).begins is None
    FIELD.begun(own.begins, 0)


@pytest.mark.slow
def test_a_training_that_goes_on_takes_fewer_steps(folder: Path, tmp_path: Path) -> None:
    own = Course(learner=FIELD, folder=tmp_path, recipe=recipe(), start=str(folder / "field.onnx"))
    school(own, silently, str)
    assert read_checkpoint(tmp_path / "checkpoint.pt")["step"] == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"seed": 1}, "recipe.seed: 0 there, 1 asked for"),
        ({"from_scratch": {"steps": 7, "rate": 2e-3}}, "recipe.from_scratch.steps: 6 there, 7"),
        ({"held_out": FEW | {"rig": 2, "first_rig": 9}}, "recipe.held_out.rig: 1 there, 2"),
    ],
)
def test_a_folder_of_another_recipe_is_refused(
    folder: Path, changed: dict[str, Any], said: str
) -> None:
    with pytest.raises(PrunusError, match=said):
        school(course(folder, **changed), silently, str)


@pytest.mark.parametrize("content", [b"no network", b"PK"])
@pytest.mark.parametrize("name", ["mine.onnx", "mine.pt"])
def test_going_on_from_what_is_no_network_blames_the_option(
    tmp_path: Path, name: str, content: bytes
) -> None:
    (tmp_path / name).write_bytes(content)
    own = Course(
        learner=FIELD, folder=tmp_path / "run", recipe=recipe(), start=str(tmp_path / name)
    )
    with pytest.raises(OptionError, match=name):
        school(own, silently, str)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("steps = 5000", "steps"),
        ("rate = 2e-3", "rate"),
        ("first_rig = 800000", "held_out: rig_seeds"),
    ],
)
def test_a_recipe_that_makes_no_sense_is_named(tmp_path: Path, line: str, said: str) -> None:
    path = tmp_path / "mine.toml"
    wrong = "first_rig = 699999" if "rig" in line else line.partition("=")[0] + "= -1"
    path.write_text(shipped_recipe("field").read_text().replace(line, wrong))
    with pytest.raises(PrunusError, match=f"mine.toml.*{said}"):
        recipe_of(path)


def test_a_scan_of_too_few_points_is_left_out_and_not_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(field_examples, "FEWEST_POINTS", 10**9)
    wanted = making.examples_to_make(tmp_path, recipe().examples)
    assert [one.done for one in wanted] == [False, False]
    list(making.make_examples(wanted, FieldExample, 1))
    assert [(one.done, one.path.exists()) for one in wanted] == [(True, False)] * 2


@pytest.mark.parametrize(("trees", "held_out"), [(1, []), (4, []), (5, [4]), (11, [4, 9])])
def test_some_of_enough_corrected_trees_are_held_out(trees: int, held_out: list[int]) -> None:
    paths = [Path(f"{number:03d}-tree.npz") for number in range(trees)]
    learned, others = split(paths)
    assert others == [paths[number] for number in held_out]
    assert sorted(learned + others) == paths


@pytest.mark.slow
def test_a_corrected_tree_is_learned_from_and_said_to_be_little(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Tree(Corrected):
        made_of = "digest"

    def example(subject: Corrected) -> FieldExample:
        return FieldExample.read(min((folder / "held-out").glob("*.npz")))

    monkeypatch.setattr(field_corrected, "corrected_example", example)
    read = list[Path]()
    drawn = Training.drawn
    monkeypatch.setattr(
        Training, "drawn", lambda own, rng: read.append(drawn(own, rng)) or read[-1]
    )
    own = Course(
        learner=FIELD,
        folder=tmp_path,
        recipe=recipe(),
        corrected=[Tree(Path("apple"), None)],
        start="scratch",
    )
    note, *lines = school(own, silently, str)
    assert "1 corrected tree, fewer than 5, is little" in note
    assert not any(line.startswith("corrected") for line in lines)
    assert {path.parent.name for path in read} == {"examples", "corrected"}
    with pytest.raises(PrunusError, match=r"corrected\.000-apple: digest there, None asked for"):
        school(course(tmp_path), silently, str)


@pytest.mark.slow
def test_the_losses_fall_on_one_scan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(training, "KEPT_EVERY", 5)
    (one,) = making.examples_to_make(tmp_path, recipe(examples=FEW | {"rig": 1}).examples)
    list(making.make_examples([one], FieldExample, 1))
    own = Training(
        folder=tmp_path, lesson=field_losses, simulated=[one.path], steps=Steps(steps=30, rate=2e-3)
    )
    train(own, FIELD.begun(None, 0), silently)
    first, *_, last = logged(tmp_path)
    assert last["step"] == 30
    for name in ("role", "log_radius", "toward_foot"):
        assert last[name] < 0.9 * first[name], name
    assert last["accuracy"] > first["accuracy"]


def test_a_tree_still_in_work_is_named_and_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    courses = list[Course]()

    def begun(course: Course, *_: Any) -> list[str]:
        courses.append(course)
        return ["done"]

    monkeypatch.setattr("prunus.lab.experiment.gold.corrected_in", lambda *_: ([], ["half"]))
    monkeypatch.setattr("prunus.lab.learn.school.school", begun)
    done = prunus("train", tmp_path, "--network", "field", "-o", tmp_path / "run")
    assert done.exit_code == 0, done.output
    assert f"{tmp_path / 'half'}: not marked as done, so left out" in done.stderr
    assert [one.learner.name for one in courses] == ["field"]
