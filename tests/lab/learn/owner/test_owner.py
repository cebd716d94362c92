"""The network that tells whose wood is, trained on small rows: resumed, exported, compared."""

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs torch: pip install 'prunus[train]'")

from prunus.growth.belonging import SHIPPED, asked  # noqa: E402
from prunus.lab.learn import making, training  # noqa: E402
from prunus.lab.learn.learners import LEARNERS, OWNER  # noqa: E402
from prunus.lab.learn.losses import logged  # noqa: E402
from prunus.lab.learn.owner.examples import OwnerExample, owner_lesson  # noqa: E402
from prunus.lab.learn.owner.lessons import losses_of, owner_losses  # noqa: E402
from prunus.lab.learn.recipe import Recipe, Steps, recipe_of  # noqa: E402
from prunus.lab.learn.school import Course, school  # noqa: E402
from prunus.lab.learn.training import Training, read_checkpoint, train  # noqa: E402
from prunus.lab.simulate.scan import Scan, simulate_scan  # noqa: E402
from tests.growth.drawn import TEXTBOOK, threads_of  # noqa: E402

FEET = 2


def drawn_row(seed: int) -> OwnerExample:
    """Two textbook trees, the second 2.1 m to the right."""
    one, other = (threads_of(TEXTBOOK, seed + number) for number in range(FEET))

    def both(name: str, shift: float = 0.0) -> Any:
        return np.concatenate([getattr(one, name), getattr(other, name) + shift])

    return OwnerExample(
        xyz=np.concatenate([one.xyz, other.xyz + np.array([2.1, 0, 0])]),
        role=both("role"),
        radius=both("radius"),
        toward_foot=both("toward_foot"),
        votes=both("votes"),
        tree=np.repeat([0, 1], len(one)),
    )


def silently(items: Iterable[Any], name: str, total: int) -> Iterable[Any]:
    return items


def dying_after(count: int) -> Callable[..., Iterator[Any]]:
    def watch(items: Iterable[Any], name: str, total: int) -> Iterator[Any]:
        for number, item in enumerate(items):
            if number == count:
                raise KeyboardInterrupt
            yield item

    return watch


@pytest.fixture
def rows(tmp_path: Path) -> list[Path]:
    paths = [tmp_path / f"{seed}.npz" for seed in range(2)]
    for seed, path in enumerate(paths):
        drawn_row(10 * seed).write(path)
    return paths


def lesson() -> Any:
    found = owner_lesson(drawn_row(0))
    assert found is not None
    return found


def training_in(folder: Path, rows: list[Path], steps: int = 4) -> Training:
    own = Steps(steps=steps, rate=2e-3)
    return Training(folder=folder, lesson=owner_losses, simulated=rows, steps=own)


def test_an_interrupted_training_ends_as_one_that_was_not(
    tmp_path: Path, rows: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(training, "KEPT_EVERY", 2)
    whole = train(training_in(tmp_path / "whole", rows), OWNER.begun(None, 0), silently)
    own = training_in(tmp_path / "own", rows)
    with pytest.raises(KeyboardInterrupt):
        train(own, OWNER.begun(None, 0), dying_after(3))
    assert read_checkpoint(own.checkpoint)["step"] == 2
    resumed = train(own, OWNER.begun(None, 0), silently).state_dict()
    assert all(torch.equal(one, resumed[name]) for name, one in whole.state_dict().items())


def test_the_loss_falls_on_one_row(
    tmp_path: Path, rows: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(training, "KEPT_EVERY", 4)
    train(training_in(tmp_path, rows[:1], 16), OWNER.begun(None, 0), silently)
    first, *_, last = logged(tmp_path)
    assert last["owner"] < 0.9 * first["owner"]


def test_the_weights_say_what_the_network_says(tmp_path: Path, rows: list[Path]) -> None:
    net, path = OWNER.begun(None, 3), tmp_path / "owner.onnx"
    path.write_bytes(OWNER.onnx(net, rows[0]))
    own = lesson()
    said = asked(own.tokens, path)
    for foot in range(FEET):
        shown = own.tokens.shown(foot, np.arange(len(own.tokens.xyz)))
        expected = net(*(torch.from_numpy(one) for one in shown.values())).detach().numpy()
        assert said[foot] == pytest.approx(expected, abs=1e-4)


def test_training_goes_on_from_the_shipped_weights(tmp_path: Path, rows: list[Path]) -> None:
    net, path = OWNER.begun(SHIPPED, 0), tmp_path / "again.onnx"
    path.write_bytes(OWNER.onnx(net, rows[0]))
    own = lesson()
    assert asked(own.tokens, path) == pytest.approx(asked(own.tokens, SHIPPED), abs=1e-4)


def test_an_example_is_read_as_it_was_written(tmp_path: Path, rows: list[Path]) -> None:
    again, own = OwnerExample.read(rows[0]), drawn_row(0)
    assert np.array_equal(again.tree, own.tree)
    assert again.xyz == pytest.approx(own.xyz, abs=1e-6)


def test_the_tree_of_each_node_of_a_simulated_row_is_known() -> None:
    scan = simulate_scan(700000)
    example = OwnerExample.of(scan, np.random.default_rng(0))
    places = [tree.xyz[0] for tree in scan.row.trees]
    found = owner_lesson(example)
    assert found is not None and example.lacks is None
    for foot, tree in zip(found.tokens.feet, found.tree.tolist(), strict=True):
        if tree >= 0:
            away = [np.linalg.norm(foot[:2] - place[:2]) for place in places]
            assert away[tree] == pytest.approx(min(away), abs=0.1)
    assert (example.tree >= 0).mean() > 0.9


def test_of_a_tree_that_stands_alone_nothing_is_learned() -> None:
    alone = drawn_row(0).take(drawn_row(0).tree == 0)
    assert alone.lacks == "1 feet"
    assert owner_lesson(alone) is None


@pytest.mark.parametrize("seed", range(3))
def test_a_row_shown_otherwise_keeps_its_truth(seed: int) -> None:
    own = drawn_row(0).shown(np.random.default_rng(seed))
    assert set(own.tree.tolist()) <= {0, 1}
    assert np.linalg.norm(own.toward_foot, axis=1) == pytest.approx(np.ones(len(own.xyz)))


def right_logits(own: Any, sure: float) -> Any:
    known = own.whose[:, :-1].sum(axis=1)
    share = own.whose[:, own.tree].T / np.maximum(known, 1e-9)
    return torch.from_numpy(np.vstack([sure * (2 * share - 1), np.zeros(share.shape[1])])).float()


def test_what_is_right_costs_nothing_and_what_is_wrong_much() -> None:
    own = lesson()
    loss, told = losses_of(right_logits(own, 30.0), own)
    assert float(loss) < 1e-3 and float(told["owned"]) == pytest.approx(1)
    loss, told = losses_of(right_logits(own, -30.0), own)
    assert float(loss) > 10 and float(told["owned"]) < 0.01


def test_wood_of_which_nobody_knows_the_tree_counts_for_nothing() -> None:
    row = drawn_row(0)
    tree = np.where(row.xyz[:, 2] > 1.0, -1, row.tree)
    held = {name: getattr(row, name) for name in ("xyz", "role", "radius", "toward_foot", "votes")}
    own = owner_lesson(OwnerExample(**held, tree=tree))
    assert own is not None
    logits = right_logits(own, 30.0)
    logits[:2, torch.from_numpy(own.whose[:, -1] == 1)] = 7.0
    assert float(losses_of(logits, own)[0]) < 1e-3


def test_of_two_feet_of_one_tree_either_is_right() -> None:
    own = lesson()
    double = type(own)(
        tokens=own.tokens, feet=np.array([0, 0, 1]), tree=own.tree[[0, 0, 1]],
        whose=own.whose, nodes=own.nodes, by_cost=own.by_cost[[0, 0, 1]],
    )  # fmt: skip
    logits = right_logits(own, 30.0)[[0, 0, 1, 2]]
    logits[0] = -30.0
    assert float(losses_of(logits, double)[0]) < 1e-3


@pytest.mark.slow
def test_a_whole_training_makes_weights_and_a_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def scan(seed: int, setting: str) -> Scan:
        return simulate_scan(700000)

    monkeypatch.setattr(making, "simulate_scan", scan)
    few = {"wide": 0, "first_wide": 0, "rig": 1, "first_rig": 0, "clean_every": 8}
    recipe = Recipe.model_validate(
        recipe_of(None, "owner").model_dump()
        | {"examples": few, "held_out": few | {"first_rig": 1}}
        | {"from_scratch": {"steps": 2, "rate": 1e-3}}
    )
    lines = school(Course(learner=OWNER, folder=tmp_path, recipe=recipe), silently, str)
    assert any(line.startswith("| wood of its tree, kept") for line in lines)
    assert {"owner.onnx", "owner.json", "log.jsonl"} <= {one.name for one in tmp_path.iterdir()}


@pytest.mark.parametrize("name", LEARNERS)
def test_every_learner_has_a_recipe_and_weights_that_ship(name: str) -> None:
    assert recipe_of(None, name).seed == 0
    LEARNERS[name].begun(LEARNERS[name].shipped, 0)
