"""A simulated orchard: true skeletons from a seed, and scans of the row they stand in."""

from prunus.lab.simulate.grow import grow_tree
from prunus.lab.simulate.habits import Habits, ufo_habits
from prunus.lab.simulate.scan import Scan, simulate_scan

__all__ = ["Habits", "Scan", "grow_tree", "simulate_scan", "ufo_habits"]
