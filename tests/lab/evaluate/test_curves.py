"""Curve measures on drawn trees."""

import numpy as np
import pytest

from prunus.lab.evaluate.curves import curve_measures, sampled
from prunus.model import RigidMotion, Skeleton
from tests.drawn import TREE, tree


def test_a_tree_is_all_of_itself() -> None:
    measures = curve_measures(tree(), tree())
    assert all(value == 1 for value in measures.values())


def test_a_shift_within_the_tolerance_costs_little_and_beyond_it_much() -> None:
    aside = RigidMotion(np.eye(3), np.array([0, 0.049, 0]))
    away = RigidMotion(np.eye(3), np.array([0, 0.051, 0]))
    assert curve_measures(tree().moved(aside), tree())["geometry_recall"] == 1
    assert curve_measures(tree().moved(away), tree())["geometry_recall"] == 0


def test_a_missing_leader_costs_its_share_of_recall_only() -> None:
    without = tree(TREE.replace("l   l  l", "l   l   ").replace("l   lb l", "l   lb  "))
    measures = curve_measures(without, tree())
    assert measures["leader_precision"] == 1
    assert measures["leader_recall"] == pytest.approx(2 / 3, abs=0.02)
    assert measures["support_f1"] == 1


def test_a_label_that_neither_has_is_unknown() -> None:
    measures = curve_measures(tree("l\ns\nt\no"), tree("l\ns\nt\no"))
    assert np.isnan(measures["side_branch_recall"])


def test_samples_stand_a_centimetre_apart_with_the_label_of_their_edge() -> None:
    points, labels = sampled(Skeleton.build([[0, 0, 0], [0, 0, 0.1]], [-1, 0], [0, 0]))
    assert points[:, 2] == pytest.approx(np.arange(10) / 100 + 0.005)
    assert (labels == 0).all()
