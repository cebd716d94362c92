"""Recipes: what each network is shown in training, in which batches, with what steps.

The paper's network learns from edges drawn so that the classes are even; ours from whole graphs,
rare categories weighing more.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch
from torch import Tensor, nn

from prunus.learn.examples import Example
from prunus.learn.labels import INVALID, SOME
from prunus.learn.net import ContextNet, PaperNet
from prunus.learn.start import start_from
from prunus.model import Ints

INPUTS = {
    "paper": ("image", "description"),
    "ours": ("profile", "bend", "edge", "met", "meeting"),
}
"""Names of the inputs of the exported networks; their outputs are confidence and category."""

Batch = tuple[tuple[Tensor, ...], Tensor]
"""Inputs of a network, and the category (E,) of each edge."""


class Recipe(Protocol):
    """How one network is trained."""

    rate: float
    epochs: int
    weights: Tensor | None
    """Of the five categories in the category loss."""
    start: Path | None
    """The exported network to go on from."""

    def network(self) -> nn.Module:
        """The network as training begins."""

    def batches(self, examples: list[Example], rng: np.random.Generator) -> Iterator[Batch]:
        """One epoch's batches."""

    def judged(self, examples: list[Example]) -> Iterator[Batch]:
        """Edges to judge a network by, as often valid and of each category as they come."""


@dataclass
class PaperRecipe:
    """Edges drawn from all examples so that the classes are even."""

    epochs: int = 10
    rate: float = 1e-3
    edges: int = 60_000
    size: int = 256
    every: int = 10
    weights: Tensor | None = None
    start: Path | None = None

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


@dataclass
class ContextRecipe:
    """Whole graphs, a few at a time."""

    epochs: int = 12
    rate: float = 2e-3
    graphs: int = 4
    weights: Tensor | None = None
    start: Path | None = None

    def network(self) -> nn.Module:
        """Each edge among those that it meets."""
        return begun(ContextNet(), self.start)

    def batches(self, examples: list[Example], rng: np.random.Generator) -> Iterator[Batch]:
        """Batches of `graphs` graphs side by side, each example once.

        Where there are two kinds of them, as many of each: those of the rarer more than once, or
        in going on from a network not all of the other.
        """
        by_kind = kinds(examples)
        counts = [len(own) for own in by_kind]
        count = max(counts) if self.start is None else min(counts)
        return taking_turns([self._drawn(own, count, rng) for own in by_kind])

    def _drawn(
        self, examples: list[Example], count: int, rng: np.random.Generator
    ) -> Iterator[Batch]:
        rounds = math.ceil(count / len(examples))
        order = np.concatenate([rng.permutation(len(examples)) for _ in range(rounds)])[:count]
        for rows in np.array_split(order, math.ceil(len(order) / self.graphs)):
            yield side_by_side([examples[row] for row in rows])

    def judged(self, examples: list[Example]) -> Iterator[Batch]:
        """Every graph, whole."""
        yield from map(self.seen, examples)

    def seen(self, example: Example) -> Batch:
        """The fields of the context of an example."""
        return side_by_side([example])


RECIPES: dict[str, type[PaperRecipe] | type[ContextRecipe]] = {
    "paper": PaperRecipe,
    "ours": ContextRecipe,
}
FURTHER: dict[str, Callable[..., PaperRecipe | ContextRecipe]] = {
    "paper": partial(PaperRecipe, epochs=4, rate=1e-4, edges=6000),
    "ours": partial(ContextRecipe, epochs=4, rate=3e-4),
}
"""For going on from a network: fewer and smaller steps, so that it forgets little."""


def recipe_for(
    name: str, start: Path | None, epochs: int | None = None
) -> PaperRecipe | ContextRecipe:
    """The recipe of a network: from scratch, or gently on from an exported one."""
    recipe = RECIPES[name]() if start is None else FURTHER[name](start=start)
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


def side_by_side(examples: list[Example]) -> Batch:
    """Some graphs as one that falls in pieces."""
    offsets = np.cumsum([0, *(len(one.category) for one in examples[:-1])])
    met = [
        np.where(one.context.met < 0, -1, one.context.met + offset)
        for one, offset in zip(examples, offsets, strict=True)
    ]
    names = ("profile", "bend", "edge", "meeting")
    profile, bend, edge, meeting = (
        np.concatenate([getattr(one.context, name) for one in examples]) for name in names
    )
    category = np.concatenate([one.category for one in examples])
    inputs = tensors(profile, bend, edge, np.concatenate(met), meeting)
    return inputs, torch.from_numpy(category)


def tensors(*arrays: Any) -> tuple[Tensor, ...]:
    """Torch's view of arrays."""
    return tuple(torch.from_numpy(np.ascontiguousarray(array)) for array in arrays)
