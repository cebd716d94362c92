"""The pruning plan: rules on a skeleton, cuts as a robot needs them, and why the rest is left."""

from prunus.measure.cuts.plan import Cut, Plan, plan_cuts
from prunus.measure.cuts.reach import Approach
from prunus.measure.cuts.rules import RULES, Left
from prunus.measure.cuts.settings import CutRules, shipped_rules

__all__ = [
    "RULES",
    "Approach",
    "Cut",
    "CutRules",
    "Left",
    "Plan",
    "plan_cuts",
    "shipped_rules",
]
