"""What a UFO tree is. The only file that knows the orchard system.

Labels in order of growth, which of them the search assigns, where they should grow, how often a
trunk may split (secs. UFO tree description, Topological and Geometric constraints).
"""

import math

from prunus.model.skeleton import Label

SEARCHED = (Label.TRUNK, Label.SUPPORT, Label.LEADER)
"""The labels that the population search assigns; side branches are found afterwards."""

TIP_LABEL = Label.LEADER
"""What ends in a tip: its order says how many changes of label a path may still hold."""

GROWTH_TARGET = {Label.SUPPORT: 0.0, Label.LEADER: math.pi / 2}
"""Expected GrowAngle, radians; the other labels grow as they like (eq. DeltaTarget)."""

MAX_SUPPORTS = 2
"""Supports that may leave the top of the trunk (trunk-support split)."""

SIDE_BRANCH_PARENTS = (Label.LEADER,)
"""What side branches leave from."""
