"""Methods as values: two parts of smaller parts, each of which can be another."""

from dataclasses import FrozenInstanceError, replace
from functools import cache, partial

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.growth.chain import Growth, Votes
from prunus.growth.parents import choose_parents
from prunus.lab.experiment.orchard import Tree, tree_of
from prunus.lab.experiment.trial import ABLATIONS, WAYS, Way
from prunus.method import Method
from prunus.model import Skeleton
from prunus.paper.chain import ScoredEdges, Search
from prunus.paper.confidence import ConstantScorer
from prunus.params import Parameters
from prunus.pipeline import follow
from prunus.result import Result

FEW = {"default": Parameters(), "paper": Parameters.paper().changed("search", K=20)}


@cache
def tree() -> Tree:
    return tree_of(900_003, "hard")


@cache
def found(way: Way | None = None, method: str = "default") -> Result:
    params = FEW[way.params.method if way else method]
    base = tree().truth.xyz[0] if way is None or way.base else None
    return follow(tree().cloud, base, params, method=way and way.method(tree()))


def alike(one: Skeleton, other: Skeleton) -> bool:
    return len(one) == len(other) and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in ("xyz", "label")
    )


def test_parameters_name_their_method() -> None:
    assert Method.of(Parameters()) == Method.default()
    assert Method.of(Parameters.paper()) == Method.paper()
    assert Method.default() == Method(evidence=Votes(), tree=Growth())
    assert Method.paper() == Method(evidence=ScoredEdges(), tree=Search())


def test_a_method_is_a_value() -> None:
    with pytest.raises(FrozenInstanceError):
        Method.default().tree = Search()  # type: ignore[misc]
    named = Method(evidence=Votes(), tree=Growth(choose=partial(choose_parents)))
    assert named != Method.default()
    again = follow(tree().cloud, tree().truth.xyz[0], method=named)
    assert alike(again.skeleton, found().skeleton)


def test_a_part_that_is_replaced_is_the_one_that_is_run() -> None:
    asked = []

    def see(voxels: object) -> None:
        asked.append(voxels)
        raise PrunusError("asked")

    method = replace(Method.default(), evidence=Votes(see=see))
    with pytest.raises(PrunusError, match="asked"):
        follow(tree().cloud, method=method)
    assert len(asked) == 1


def test_only_edges_are_scored() -> None:
    scorer = ConstantScorer(0.5)
    assert Method.paper().scored_by(scorer) == Method(
        evidence=ScoredEdges(scorer=scorer), tree=Search()
    )
    with pytest.raises(PrunusError, match='scorer: of no use to the method "default"'):
        Method.default().scored_by(scorer)


@pytest.mark.parametrize("way", [*WAYS, *ABLATIONS], ids=lambda way: way.name)
@pytest.mark.slow
def test_every_row_of_the_experiment_is_its_method_or_another(way: Way) -> None:
    same = way.method(tree()) == Method.of(way.params)
    assert same == (way.name in ("paper", "default", "default, base found"))
    if not same and "wires" not in way.name:  # where no wire is in view it brings nothing
        assert not alike(found(way).skeleton, found(method=way.params.method).skeleton)


def test_with_true_classes_labels_are_hardly_wrong() -> None:
    (told,) = (way for way in WAYS if way.name == "default, true classes")
    truth = tree().truth
    wrong = []
    for result in (found(), found(told)):
        away = np.linalg.norm(result.skeleton.xyz[:, None] - truth.xyz, axis=2)
        near = away.min(axis=1) < 0.03
        label = truth.label[away.argmin(axis=1)]
        wrong.append((result.skeleton.label[near] != label[near]).mean())
    assert wrong[1] < wrong[0]
