"""The learned edge confidence: networks made by `prunus train`, run by onnxruntime (no torch)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prunus.errors import PrunusError
from prunus.model import CandidateGraph, Floats
from prunus.paper.images import description, edge_images
from prunus.weights import WEIGHTS, open_network

SHIPPED = WEIGHTS / "paper.onnx"
"""The network that the package ships, made by `prunus train`."""


def shipped_or_own(name: str) -> Path:
    """The file of a network: `paper` is the one that the package ships."""
    return SHIPPED if name == "paper" else Path(name)


SHOWN = (frozenset({"image", "description"}),)
TOLD = frozenset({"confidence", "category"})
"""What an edge network is shown, and what it tells."""


@dataclass(frozen=True)
class NetworkScorer:
    """An edge network from an ONNX file; that of the package where none is named."""

    path: Path = SHIPPED
    name: str = "cnn"

    def __post_init__(self) -> None:
        if not isinstance(self.path, str | Path):
            raise PrunusError(f"network: {self.path!r}; expected the name of an ONNX file")
        object.__setattr__(self, "path", Path(self.path))

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
        shown = {"image": edge_images(candidates), "description": description(candidates)}
        try:
            told = session.run(["confidence", "category"], shown)
        except Exception as error:
            # the errors of onnxruntime share no class, and what they are depends on the network
            raise PrunusError(f"{self.path}: {_not_ours(error)}") from error
        return told[0], told[1]


def _not_ours(error: Exception) -> str:
    return (
        f"the network does not take what it is shown ({type(error).__name__}); "
        "expected one that `prunus train` of this version made"
    )
