"""The pruning plan: rules on a skeleton, cuts as a robot needs them, and why the rest is left."""

from prunus.cuts.plan import Cut, Plan, plan_cuts
from prunus.cuts.reach import Approach
from prunus.cuts.rules import RULES, Left
from prunus.cuts.settings import CutRules, shipped_rules

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
