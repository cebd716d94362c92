"""The learned edge confidence: networks made by `prunus.learn`, run by onnxruntime (no torch)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.model import CandidateGraph, Floats
from prunus.networks import WEIGHTS, open_network
from prunus.stages.context import context_of, description
from prunus.stages.images import edge_images


def shipped_or_own(name: str) -> Path:
    """The file of a network: `ours` and `paper` are those that the package ships."""
    return WEIGHTS / f"{name}.onnx" if name in ("ours", "paper") else Path(name)


SHOWN = (
    frozenset({"image", "description"}),
    frozenset({"profile", "bend", "edge", "met", "meeting"}),
)
TOLD = frozenset({"confidence", "category"})
"""What edge networks are shown, and what they tell."""


@dataclass(frozen=True)
class NetworkScorer:
    """An edge network from an ONNX file; its inputs say what it wants to see."""

    path: Path = WEIGHTS / "ours.onnx"
    name: str = "cnn"
    floor: float = 0.30

    def __post_init__(self) -> None:
        if not isinstance(self.path, str | Path):
            raise PrunusError(f"network: {self.path!r}; expected the name of an ONNX file")
        object.__setattr__(self, "path", Path(self.path))

    @classmethod
    def shipped(cls, edge_net: str) -> NetworkScorer:
        """The network that the package ships under that name: paper or ours."""
        return cls(WEIGHTS / f"{edge_net}.onnx", "cnn" if edge_net == "ours" else f"cnn {edge_net}")

    def check(self) -> None:
        """Raise PrunusError where the file is no edge network."""
        open_network(self.path, SHOWN, TOLD)

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """Confidence (E,)."""
        return self.judge(candidates)[0]

    def judge(self, candidates: CandidateGraph) -> tuple[Floats, Floats]:
        """Confidence (E,), and the probability (E, 5) of each category should the edge be valid.

        The categories are trunk, support, leader, side branch and other wood.
        Raises PrunusError where the file is no edge network.
        """
        if len(candidates.edges) == 0:
            return np.zeros(0), np.zeros((0, 5))
        session = open_network(self.path, SHOWN, TOLD)
        shown = _shown(candidates, [one.name for one in session.get_inputs()])
        try:
            told = session.run(["confidence", "category"], shown)
        except Exception as error:
            # the errors of onnxruntime share no class, and what they are depends on the network
            raise PrunusError(f"{self.path}: {_not_ours(error)}") from error
        return told[0], told[1]


def _shown(candidates: CandidateGraph, wanted: list[str]) -> dict[str, Any]:
    """What a network with inputs of these names sees."""
    if "image" in wanted:
        return {"image": edge_images(candidates), "description": description(candidates)}
    context = context_of(candidates)
    return {name: getattr(context, name) for name in wanted}


def _not_ours(error: Exception) -> str:
    return (
        f"the network does not take what it is shown ({type(error).__name__}); "
        "expected one that `prunus train` of this version made"
    )
