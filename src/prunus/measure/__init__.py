"""What a robot or a breeder asks of a skeleton."""

from prunus.measure.branches import Branch, branch_of_rows, branches, lengths_by_label, orders
from prunus.measure.leaders import Leader, leaders
from prunus.measure.remarks import remarks
from prunus.measure.seen import COUNTS, counting_rows, shown

__all__ = [
    "COUNTS",
    "Branch",
    "Leader",
    "branch_of_rows",
    "branches",
    "counting_rows",
    "leaders",
    "lengths_by_label",
    "orders",
    "remarks",
    "shown",
]
