"""One branch has one name, wherever it is read."""

import numpy as np

from prunus.cuts import plan_cuts
from prunus.model import PointCloud
from prunus.model.branch_names import branch_names
from prunus.model.branches import branches
from prunus.refine.refined import refined
from prunus.traits.traits import branch_traits
from tests.drawn import tree

CROWDED = """
l b  l
l b  l
l b  l
lbbblb
l b  l
ssstss
   t
   o
"""
"""Of two leaders over one another, which is named first hangs by a hair."""


def test_refining_leaves_the_names() -> None:
    drawn = tree(CROWDED)
    steps = np.linspace(0, 1, 40)[:, None, None]
    points = drawn.xyz[drawn.parent[1:]] * (1 - steps) + drawn.xyz[1:] * steps
    fine = refined(drawn, PointCloud.from_xyz(points.reshape(-1, 3)))
    names = branch_names(drawn, branches(drawn))
    assert fine.names == names
    assert [row["name"] for row in branch_traits(fine)] == names
    looked_at = [one.branch for one in (*plan_cuts(fine).cuts, *plan_cuts(fine).left)]
    assert set(looked_at) <= set(names)
