"""How far to trust a skeleton, as `skeleton.json` has it."""

from __future__ import annotations

from prunus.io.skeletons.skeleton_file import DIGITS, TrustRecord
from prunus.model import Floats, Skeleton
from prunus.model.branch_names import branch_names
from prunus.model.branches import branches
from prunus.trust import Trust


def trust_record(skeleton: Skeleton, trust: Trust | None) -> TrustRecord | None:
    """The trust in a skeleton, house frame, as `skeleton.json` has it."""
    if trust is None:
        return None
    found = branches(skeleton)
    names = branch_names(skeleton, found)
    rows = [
        {"number": number, "name": name, "label": one.label.word, "nodes": one.rows.tolist(),
         "trust": likely}
        for number, (name, one, likely) in enumerate(
            zip(names, found, _rounded(trust.branch), strict=True)
        )
    ]  # fmt: skip
    edges = [None, *_rounded(trust.edge[1:])]
    return TrustRecord.model_validate(
        {"tree": round(trust.tree, DIGITS), "edges": edges, "branches": rows}
    )


def _rounded(values: Floats) -> list[float]:
    return [round(value, DIGITS) for value in values.tolist()]
