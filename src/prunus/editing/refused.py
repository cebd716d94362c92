"""An act that is not done, and what could be done in its place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from prunus.editing.acts import Act
from prunus.editing.draft import Draft
from prunus.errors import PrunusError
from prunus.model import Floats

Repairs = list[tuple[str, Act]]
"""What could be done instead, in words such as `becomes a side branch of leader 3`."""


class Refused(PrunusError):  # noqa: N818, it is an answer
    """An act that would leave no legal tree.

    `rule` is one of `rules.py`, or of `OTHERS` (words.py); `nodes` are where it would be broken,
    and `places` (k, 3), house frame, where those are, some perhaps not in the tree yet; each of
    `repairs` can be done as it is.
    """

    def __init__(
        self,
        text: str,
        rule: str,
        nodes: Sequence[int] = (),
        repairs: Sequence[tuple[str, Act]] = (),
    ) -> None:
        super().__init__(text)
        self.rule = rule
        self.nodes = list(nodes)
        self.repairs: Repairs = list(repairs)
        self.places: Floats = np.zeros((0, 3))

    def at(self, draft: Draft) -> Refused:
        """The same with the places of its nodes."""
        self.places = draft.places[[node for node in self.nodes if node < len(draft.places)]]
        return self
