"""Each rule returns the nodes that break it, and nothing else."""

import numpy as np
import pytest

from prunus.model import Label, Skeleton
from prunus.rules import RULES, offenders
from tests.drawn import tree


def test_a_whole_tree_breaks_no_rule() -> None:
    assert offenders(tree()) == {}


@pytest.mark.parametrize(
    ("rule", "picture", "offender"),
    [
        ("label_progression", "ls\nt\no", (0, 2)),
        ("label_linearity", "l l\n l \nst \n o ", (1, 2)),
        ("trunk_support_split", "  t\nsst\n  t\n  o", (2, 2)),
        ("trunk_support_split", " s \nsts\n o ", (1, 1)),
        ("one_trunk_at_base", "t t\n o ", (1, 0)),
        ("one_trunk_at_base", "s\no", (0, 0)),
        ("side_branches_on_leaders", "bt\n o", (1, 1)),
    ],
)
def test_a_broken_rule_names_the_node(rule: str, picture: str, offender: tuple[int, int]) -> None:
    skeleton = tree(picture)
    row = int(np.argmin(np.abs(skeleton.xyz[:, [0, 2]] * 10 - offender).sum(axis=1)))
    assert row in offenders(skeleton)[rule]


def test_the_base_alone_breaks_no_rule() -> None:
    assert offenders(Skeleton.build([[0, 0, 0]], [-1], [Label.TRUNK])) == {}


def test_every_rule_says_what_it_asks() -> None:
    assert all(rule.__doc__ for rule in RULES)
