"""Training on simulated scans: one scan a step, resumable from its last checkpoint."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from prunus.errors import PrunusError
from prunus.files.reading import read_bytes
from prunus.files.safely import write_bytes
from prunus.lab.learn.edges.lessons import Watch
from prunus.lab.learn.losses import Losses, forget_after, log_losses
from prunus.lab.learn.recipe import Steps

WEIGHT_DECAY = 1e-3
WARM_UP_STEPS, WARM_UP = 200, 0.1  # the learning rate rises over so many, or that share of all
LAST_RATE = 0.01  # it ends at this share of its highest
KEPT_EVERY = 50  # steps; so often the losses are logged too
CHECKPOINT = "checkpoint.pt"
Lesson = Callable[
    [nn.Module, Path, np.random.Generator, torch.device], tuple[Tensor, dict[str, Tensor]]
]
"""The loss of a network on the example in a file, and what is logged of it."""


@dataclass(frozen=True, kw_only=True)
class Training:
    """What is learned from, how, and kept where: `folder` holds checkpoint, log and weights.

    lesson: what is learned on an example; corrected: examples of real trees, on which `share` of
    the steps are, where there are any.
    """

    folder: Path
    lesson: Lesson
    simulated: list[Path]
    corrected: list[Path] = field(default_factory=list)
    share: float = 0.0
    steps: Steps
    seed: int = 0

    @property
    def checkpoint(self) -> Path:
        """Where the network is kept every so many steps."""
        return self.folder / CHECKPOINT

    def drawn(self, rng: np.random.Generator) -> Path:
        """The example of a step."""
        paths = self.simulated
        if self.corrected and rng.random() < self.share:
            paths = self.corrected
        return paths[rng.integers(len(paths))]


@dataclass(eq=False)
class Progress:
    """A network in training, and how many steps are done."""

    net: nn.Module
    optimizer: torch.optim.Optimizer
    step: int = 0

    @classmethod
    def begun(cls, net: nn.Module, path: Path) -> Progress:
        """The training of a network, as far as the checkpoint in a file has it, if there is one."""
        own = cls(net, torch.optim.AdamW(net.parameters(), 1.0, weight_decay=WEIGHT_DECAY))
        if path.exists():
            state = read_checkpoint(path)
            net.load_state_dict(state["net"])
            own.optimizer.load_state_dict(state["optimizer"])
            own.step = state["step"]
        return own

    def keep(self, path: Path) -> None:
        """Write a checkpoint, whole or not at all."""
        held = io.BytesIO()
        state = {"net": self.net.state_dict(), "optimizer": self.optimizer.state_dict()}
        torch.save(state | {"step": self.step}, held)
        write_bytes(path, held.getvalue())


def train(training: Training, net: nn.Module, watch: Watch[Any]) -> nn.Module:
    """Train a network until all steps are done; goes on from the last checkpoint.

    Each step is a pure function of the network and its number, so that a training that was
    interrupted ends as one that was not. A GPU does the work where torch sees one.
    """
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    last, path = training.steps.steps, training.checkpoint
    own = Progress.begun(net.to(device), path)
    forget_after(training.folder, own.step)
    numbers, recent = range(own.step, last), list[Losses]()
    for number in watch(numbers, f"steps to {last}", last - own.step):
        recent.append(_step(own, training, number, device))
        own.step = number + 1
        if own.step % KEPT_EVERY == 0 or own.step == last:
            log_losses(training.folder, own.step, recent)
            recent.clear()
            own.keep(path)
    return own.net.cpu()


def _step(own: Progress, training: Training, number: int, device: torch.device) -> Losses:
    """One step on one scan: which one, and how it is shown, follow from seed and number."""
    rng = np.random.default_rng([training.seed, number])
    for group in own.optimizer.param_groups:
        group["lr"] = rate_at(number, training.steps)
    loss, losses = training.lesson(own.net, training.drawn(rng), rng, device)
    own.optimizer.zero_grad()
    if torch.isfinite(loss):
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(own.net.parameters(), 1.0)
        own.optimizer.step()
    return {name: float(value.detach()) for name, value in losses.items()}


def rate_at(step: int, steps: Steps) -> float:
    """The learning rate: a warm-up, then a half cosine."""
    cosine = 0.5 * (1 + math.cos(math.pi * step / steps.steps))
    warm_up = max(1.0, min(WARM_UP_STEPS, WARM_UP * steps.steps))
    return steps.rate * min(1.0, (step + 1) / warm_up) * (cosine + LAST_RATE)


def steps_done(training: Training) -> int:
    """How many steps the last checkpoint has done; 0 where there is none."""
    path = training.checkpoint
    return int(read_checkpoint(path)["step"]) if path.exists() else 0


def read_checkpoint(path: Path) -> dict[str, Any]:
    """What `Progress.keep` wrote, on the CPU; PrunusError where a file is no such."""
    content = read_bytes(path)
    try:
        state = torch.load(io.BytesIO(content), weights_only=True, map_location="cpu")
        return {name: state[name] for name in ("net", "optimizer", "step")}
    except Exception as error:
        # torch raises whatever unpickling trips over: the file is at fault in every case
        why = type(error).__name__
        raise PrunusError(f"{path}: not a checkpoint of a training ({why})") from error
