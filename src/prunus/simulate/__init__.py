"""A simulated orchard: true skeletons from a seed, and scans of the row they stand in."""

from prunus.simulate.grow import grow_tree
from prunus.simulate.habits import Habits, ufo_habits
from prunus.simulate.scan import Scan, simulate_scan

__all__ = ["Habits", "Scan", "grow_tree", "simulate_scan", "ufo_habits"]
