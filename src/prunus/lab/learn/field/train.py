"""Training of the point field: one scan a step, resumable from its last checkpoint."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from prunus.errors import PrunusError
from prunus.field.network import COLUMNS, OFFSET_M, RADIUS_M
from prunus.files.reading import read_bytes
from prunus.files.safely import write_bytes
from prunus.lab.learn.edges.lessons import Watch
from prunus.lab.learn.field.examples import FieldExample, Lesson, lesson_of
from prunus.lab.learn.field.losses import Losses, forget_after, log_losses
from prunus.lab.learn.field.net import FieldNet, Tables
from prunus.lab.learn.field.recipe import Steps
from prunus.lab.simulate.wide.points import UNKNOWN_ROLE, UNTOLD
from prunus.model import Role

CLASS_WEIGHT = (1.5, 1.5, 1.0, 1.3, 1.3, 1.0)  # of the roles, in the order of `Role`
LOSS_WEIGHT = {"role": 1.0, "offset": 0.7, "log_radius": 0.2, "toward_foot": 0.5}
LEAST_RADIUS_M = 0.001
FARTHEST = 4.0  # longer errors of an offset (in 3 cm) count no more
WEIGHT_DECAY = 1e-3
WARM_UP_STEPS, WARM_UP = 200, 0.1  # the learning rate rises over so many, or that share of all
LAST_RATE = 0.01  # it ends at this share of its highest
KEPT_EVERY = 50  # steps; so often the losses are logged too
CHECKPOINT = "checkpoint.pt"


@dataclass(frozen=True, eq=False, kw_only=True)
class Batch:
    """A lesson as tensors."""

    features: Tensor
    tables: Tables
    role: Tensor
    offset: Tensor
    log_radius: Tensor
    toward_foot: Tensor

    @classmethod
    def of(cls, lesson: Lesson, device: torch.device | None = None) -> Batch:
        """The batch of one lesson, on a device."""
        radius = np.maximum(lesson.radius, LEAST_RADIUS_M)
        single = [lesson.offset / OFFSET_M, np.log(radius / RADIUS_M), lesson.toward_foot]
        offset, log_radius, toward_foot = (
            torch.from_numpy(x.astype(np.float32)).to(device) for x in single
        )
        return cls(
            features=torch.from_numpy(lesson.features).to(device),
            tables=Tables.of(lesson.voxels.levels).to(device),
            role=torch.from_numpy(lesson.role).to(device),
            offset=offset,
            log_radius=log_radius,
            toward_foot=toward_foot,
        )


def losses_of(outputs: Tensor, batch: Batch) -> dict[str, Tensor]:
    """The losses of a batch by name, and `accuracy`, the share of voxels whose role is right.

    Where wood is of no known role, being taken for wood at all is what counts; where nobody knows
    whether there is wood, nothing does.
    """
    logits, offset, log_radius, direction = torch.split(outputs, list(COLUMNS.values()), dim=1)
    known, any_wood = batch.role >= 0, batch.role == UNKNOWN_ROLE
    wood = (batch.role != Role.NO_WOOD) & (batch.role != UNTOLD)
    sized = wood & batch.log_radius.isfinite()
    weight = torch.tensor(CLASS_WEIGHT, device=logits.device)
    told = nn.functional.cross_entropy(logits[known], batch.role[known], weight, reduction="sum")
    chance = logits.log_softmax(dim=1)
    told = told - chance[any_wood, : Role.NO_WOOD].logsumexp(dim=1).sum()
    counted = weight[batch.role[known]].sum() + any_wood.sum()
    error = ((offset - batch.offset)[wood] ** 2).sum(dim=1)
    unit = nn.functional.normalize(direction[wood], dim=1)
    truth = nn.functional.normalize(batch.toward_foot[wood], dim=1)
    right = (logits.argmax(dim=1) == batch.role)[known].float().mean()
    return {
        "role": told / counted,
        "offset": torch.sqrt(error + 1e-2).clamp(max=FARTHEST).mean(),
        "log_radius": (log_radius[sized, 0] - batch.log_radius[sized]).abs().sum()
        / sized.sum().clamp(min=1),
        "toward_foot": (1 - (unit * truth).sum(dim=1)).mean(),
        "accuracy": right,
    }


@dataclass(frozen=True, kw_only=True)
class Training:
    """What is learned from, how, and kept where: `folder` holds checkpoint, log and weights.

    corrected: examples of real trees, on which `share` of the steps are, where there are any.
    """

    folder: Path
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

    net: FieldNet
    optimizer: torch.optim.Optimizer
    step: int = 0

    @classmethod
    def begun(cls, net: FieldNet, path: Path) -> Progress:
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


def train_field(training: Training, net: FieldNet, watch: Watch[Any]) -> FieldNet:
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
    example = FieldExample.read(training.drawn(rng))
    batch = Batch.of(lesson_of(example.shown(rng), rng), device)
    for group in own.optimizer.param_groups:
        group["lr"] = rate_at(number, training.steps)
    losses = losses_of(own.net(batch.features, batch.tables), batch)
    loss = sum(weight * losses[name] for name, weight in LOSS_WEIGHT.items())
    assert isinstance(loss, Tensor)
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
        raise PrunusError(f"{path}: not a checkpoint of the point field ({why})") from error
