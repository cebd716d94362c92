"""A simulated orchard: true skeletons from a seed, and scans of them."""

from prunus.simulate.grow import Habits, grow_tree
from prunus.simulate.scan import Faults, scan_tree

__all__ = ["Faults", "Habits", "grow_tree", "scan_tree"]
