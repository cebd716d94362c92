"""Drawn trees for the cuts, with radii: 20 mm the support, 10 mm leaders, 5 mm side branches."""

import numpy as np

from prunus.model import Label, Skeleton
from tests.drawn import tree

TWO_LEADERS = """
l    l
lbbb lb
l    l
l    l
ssstss
   t
   o
"""
"""Two leaders 0.4 m tall and 0.5 m apart; a side branch of 0.3 m and one of 0.1 m."""
RADII = {Label.TRUNK: 0.03, Label.SUPPORT: 0.02, Label.LEADER: 0.01, Label.SIDE_BRANCH: 0.005}


def drawn(picture: str = TWO_LEADERS) -> Skeleton:
    """The drawn tree with radii and full confidence."""
    skeleton = tree(picture)
    radius = [RADII[Label(label)] for label in skeleton.label]
    return Skeleton.build(
        skeleton.xyz, skeleton.parent, skeleton.label, radius=radius,
        confidence=np.ones(len(skeleton)),
    )  # fmt: skip
