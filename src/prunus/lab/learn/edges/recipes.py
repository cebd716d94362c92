"""The recipe: what the network is shown in training, in which batches, with what steps.

It learns from edges drawn so that the classes are even.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from prunus.lab.learn.edges.examples import Example
from prunus.lab.learn.edges.labels import INVALID, SOME
from prunus.lab.learn.edges.net import PaperNet
from prunus.lab.learn.edges.start import start_from
from prunus.model import Ints

INPUTS = ("image", "description")
"""Names of the inputs of the exported network; its outputs are confidence and category."""

Batch = tuple[tuple[Tensor, ...], Tensor]
"""Inputs of a network, and the category (E,) of each edge."""


@dataclass(kw_only=True)
class Recipe:
    """Edges drawn from all examples so that the classes are even."""

    epochs: int = 10
    rate: float = 1e-3
    edges: int = 60_000
    size: int = 256
    every: int = 10
    start: Path | None = None
    """The exported network to go on from."""

    def network(self) -> nn.Module:
        """Appendix A."""
        return begun(PaperNet(), self.start)

    def batches(self, examples: list[Example], rng: np.random.Generator) -> Iterator[Batch]:
        """Batches of `size` edges with random flips, `edges` an epoch of each kind of example."""
        return taking_turns([self._drawn(own, rng) for own in kinds(examples)])

    def _drawn(self, examples: list[Example], rng: np.random.Generator) -> Iterator[Batch]:
        owner = np.repeat(np.arange(len(examples)), [len(one.category) for one in examples])
        place = np.concatenate([np.arange(len(one.category)) for one in examples])
        category = np.concatenate([one.category for one in examples])
        every = [np.flatnonzero(category == k) for k in range(INVALID, SOME + 1)]
        held = [rows for rows in every if len(rows)]
        drawn = [rng.choice(rows, self.edges // len(held)) for rows in held]
        for rows in np.array_split(rng.permutation(np.concatenate(drawn)), self.edges // self.size):
            edges = [(examples[owner[row]], place[row]) for row in rows]
            images = np.stack([one.images[k] for one, k in edges]).astype(np.float32) / 255
            flips = rng.integers(0, 2, (2, len(rows)))
            images[flips[0] == 1] = images[flips[0] == 1, ::-1]
            images[flips[1] == 1] = images[flips[1] == 1, :, ::-1]
            described = np.stack([one.described[k] for one, k in edges])
            yield tensors(images, described), torch.from_numpy(category[rows])

    def judged(self, examples: list[Example]) -> Iterator[Batch]:
        """Some edges of each example: a network that looks at four flips is slow."""
        for example in examples:
            rows = np.flatnonzero(example.told)
            yield self.seen(example, rows[:: self.every] if example.told.all() else rows)

    def seen(self, example: Example, rows: slice | Ints = slice(None)) -> Batch:
        """Images and descriptions of an example."""
        images = example.images[rows].astype(np.float32) / 255
        category = torch.from_numpy(example.category[rows])
        return tensors(images, example.described[rows]), category


def recipe_for(start: Path | None, epochs: int | None = None) -> Recipe:
    """From scratch, or from an exported network: fewer and smaller steps then, to forget little."""
    recipe = Recipe() if start is None else Recipe(start=start, epochs=4, rate=1e-4, edges=6000)
    recipe.epochs = epochs or recipe.epochs
    return recipe


def kinds(examples: list[Example]) -> list[list[Example]]:
    """The examples of which every edge is told of, and those of which a person labelled some."""
    told = [bool(one.told.all()) for one in examples]
    both = [[one for one, own in zip(examples, told, strict=True) if own == kind]
            for kind in (True, False)]  # fmt: skip
    return [own for own in both if own]


def taking_turns(several: list[Iterator[Batch]]) -> Iterator[Batch]:
    """A batch of each in turn, so that each kind counts as much, however few its edges are."""
    return (batch for batches in zip(*several, strict=True) for batch in batches)


def begun(net: nn.Module, start: Path | None) -> nn.Module:
    """The network with the parameters of the file that it starts from, if any."""
    return net if start is None else start_from(start, net)


def tensors(*arrays: Any) -> tuple[Tensor, ...]:
    """Torch's view of arrays."""
    return tuple(torch.from_numpy(np.ascontiguousarray(array)) for array in arrays)
