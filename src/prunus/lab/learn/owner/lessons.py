"""What the network that tells whose wood is learns on one scene, and how well it does on others."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from prunus.growth.belonging import asked, log_odds
from prunus.lab.learn.export import Named, onnx_of
from prunus.lab.learn.owner.examples import OwnerExample, OwnerLesson, owner_lesson
from prunus.model import Bools, Floats, Ints

NOT_ASKED = -9.0  # the logit of what is too far off to be asked about
TRIES = 10  # to show a scene with several feet
Figures = dict[str, Any]
Shares = tuple[float, float]


def owner_losses(
    net: nn.Module, path: Path, rng: np.random.Generator, device: torch.device
) -> tuple[Tensor, dict[str, Tensor]]:
    """The loss on the example in a file, shown in a way in which several feet are in view."""
    lesson = _shown(OwnerExample.read(path), rng)
    logits = torch.full((len(lesson.feet) + 1, len(lesson.nodes)), NOT_ASKED, device=device)
    logits[-1] = 0.0
    for number, foot in enumerate(lesson.feet.tolist()):
        rows = lesson.rows(foot)
        logits[number, torch.from_numpy(rows)] = net(*_tensors(lesson, foot, device).values())
    return losses_of(logits, lesson)


def owner_onnx(net: nn.Module, path: Path) -> bytes:
    """The file of a network; looks at the example in a file."""
    lesson = _shown(OwnerExample.read(path), np.random.default_rng(0))
    return onnx_of(Named(net), _tensors(lesson, 0, torch.device("cpu")), "logits")


def _tensors(lesson: OwnerLesson, foot: int, device: torch.device) -> dict[str, Tensor]:
    shown = lesson.tokens.shown(foot, lesson.rows(foot))
    return {name: torch.from_numpy(one).to(device) for name, one in shown.items()}


def _shown(example: OwnerExample, rng: np.random.Generator) -> OwnerLesson:
    """A lesson of an example: as it is, where several feet are seldom in view otherwise."""
    ways = (owner_lesson(example.shown(rng), rng) for _ in range(TRIES))
    lesson = next((one for one in ways if one is not None), None) or owner_lesson(example, rng)
    assert lesson is not None, "of an example from which something can be learned"
    return lesson


def losses_of(logits: Tensor, lesson: OwnerLesson) -> tuple[Tensor, dict[str, Tensor]]:
    """The cross entropy of logits (F + 1, T), the last of none, and the share that is right.

    Tokens count by their nodes. Of two feet of one tree either is right; where nobody knows whose
    the wood is, nothing counts.
    """
    chance = logits.log_softmax(dim=0)
    target, group = _targets(lesson)
    told = torch.stack([chance[torch.from_numpy(own)].logsumexp(dim=0) for own in group])
    share = torch.from_numpy(target.astype(np.float32)).to(logits.device)
    known = max((lesson.nodes * target.sum(axis=0)).sum(), 1)
    weight = torch.from_numpy(lesson.nodes / known).to(logits.device, torch.float32)
    right = share.gather(0, told.argmax(dim=0)[None])[0]
    loss = -(weight * (share * told).sum(dim=0)).sum()
    return loss, {"owner": loss, "owned": (weight * right).sum()}


def _targets(lesson: OwnerLesson) -> tuple[Floats, list[Ints]]:
    """The share (G, T) of each token that is of each tree asked for, and last of any other.

    With the rows of the logits that stand for each of these.
    """
    trees = np.unique(lesson.tree[lesson.tree >= 0])
    group = [np.flatnonzero(lesson.tree == one) for one in trees]
    other = np.append(np.flatnonzero(lesson.tree < 0), len(lesson.tree))
    known = lesson.whose[:, :-1]
    own = known[:, trees]
    return np.vstack([own.T, known.sum(axis=1) - own.sum(axis=1)]), [*group, other]


def owner_figures(network: Path, examples: Iterable[Path]) -> Figures:
    """Of wood around feet that is theirs, the share given to them; of other wood, that not given.

    Of a network in an ONNX file, mean over the feet of examples in files; and the same by cost.
    """
    network_gives, cost_gives = list[Shares](), list[Shares]()
    for path in examples:
        lesson = owner_lesson(OwnerExample.read(path))
        if lesson is not None:
            network_gives += _shares(log_odds(asked(lesson.tokens, network)) > 0, lesson)
            cost_gives += _shares(lesson.by_cost, lesson)
    found = {"network": network_gives, "cost": cost_gives}
    return {name: np.mean(shares, axis=0).tolist() for name, shares in found.items()}


def _shares(given: Bools | Floats, lesson: OwnerLesson) -> list[Shares]:
    """For each foot that stands on a tree, where so much of each token (F, T) is given to it."""
    found = []
    for foot, tree in zip(lesson.feet, lesson.tree, strict=True):
        own = lesson.nodes * lesson.whose[:, tree]
        other = lesson.nodes * lesson.whose[:, :-1].sum(axis=1) - own
        kept, left = (own * given[foot]).sum(), (other * (1.0 - given[foot])).sum()
        if tree >= 0 and own.sum() > 0:
            found.append((float(kept / own.sum()), float(left / max(other.sum(), 1))))
    return found


def owner_table(columns: dict[str, Figures]) -> list[str]:
    """The figures of several networks side by side, and of cost alone, as lines of Markdown."""
    every = {name: column["network"] for name, column in columns.items()}
    every["by cost"] = next(iter(columns.values()))["cost"]
    lines = [f"| | {' | '.join(every)} |", "|---" * (len(every) + 1) + "|"]
    for row, title in enumerate(("wood of its tree, kept", "wood of others, left out")):
        lines.append(f"| {title} | {' | '.join(f'{own[row]:.1%}' for own in every.values())} |")
    return lines
