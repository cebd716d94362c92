"""Training of the point field: one scan a step, resumable from its last checkpoint."""

from __future__ import annotations

import json
import math
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from prunus.field.network import COLUMNS, OFFSET_M, RADIUS_M
from prunus.io.safely import write_bytes
from prunus.lab.learn.field_examples import FieldExample, Lesson, lesson_of
from prunus.lab.learn.field_net import FieldNet, Tables
from prunus.lab.simulate.points import UNKNOWN_ROLE
from prunus.model import Role

CLASS_WEIGHT = (1.5, 1.5, 1.0, 1.3, 1.3, 1.0)  # of the roles, in the order of `Role`
LOSS_WEIGHT = {"role": 1.0, "offset": 0.7, "log_radius": 0.2, "toward_foot": 0.5}
LEAST_RADIUS_M = 0.001
FARTHEST = 4.0  # longer errors of an offset (in 3 cm) count no more
LEARNING_RATE, WEIGHT_DECAY, WARM_UP_STEPS = 2e-3, 1e-3, 200
LAST_RATE = 0.01  # the learning rate ends at this share of its highest
LOGGED_EVERY, KEPT_EVERY = 50, 200


@dataclass(frozen=True, eq=False, kw_only=True)
class Batch:
    """A lesson as tensors; `wood` (V,) where there is any."""

    features: Tensor
    tables: Tables
    role: Tensor
    offset: Tensor
    log_radius: Tensor
    toward_foot: Tensor

    @classmethod
    def of(cls, lesson: Lesson) -> Batch:
        """The batch of one lesson."""
        radius = np.maximum(lesson.radius, LEAST_RADIUS_M)
        single = [lesson.offset / OFFSET_M, np.log(radius / RADIUS_M), lesson.toward_foot]
        offset, log_radius, toward_foot = (torch.from_numpy(x.astype(np.float32)) for x in single)
        return cls(
            features=torch.from_numpy(lesson.features),
            tables=Tables.of(lesson.voxels.levels),
            role=torch.from_numpy(lesson.role),
            offset=offset,
            log_radius=log_radius,
            toward_foot=toward_foot,
        )


def losses_of(outputs: Tensor, batch: Batch) -> dict[str, Tensor]:
    """The losses of a batch by name, and `accuracy`, the share of voxels whose role is right.

    Where wood is of no known role, being taken for wood at all is what counts.
    """
    logits, offset, log_radius, direction = torch.split(outputs, list(COLUMNS.values()), dim=1)
    known, wood = batch.role != UNKNOWN_ROLE, batch.role != Role.NO_WOOD
    weight = torch.tensor(CLASS_WEIGHT)
    told = nn.functional.cross_entropy(logits[known], batch.role[known], weight, reduction="sum")
    chance = logits.log_softmax(dim=1)
    any_wood = -chance[~known, : Role.NO_WOOD].logsumexp(dim=1).sum()
    counted = weight[batch.role[known]].sum() + (~known).sum()
    error = ((offset - batch.offset)[wood] ** 2).sum(dim=1)
    unit = nn.functional.normalize(direction[wood], dim=1)
    truth = nn.functional.normalize(batch.toward_foot[wood], dim=1)
    right = (logits.argmax(dim=1) == batch.role)[known].float().mean()
    return {
        "role": (told + any_wood) / counted,
        "offset": torch.sqrt(error + 1e-2).clamp(max=FARTHEST).mean(),
        "log_radius": (log_radius[wood, 0] - batch.log_radius[wood]).abs().mean(),
        "toward_foot": (1 - (unit * truth).sum(dim=1)).mean(),
        "accuracy": right,
    }


@dataclass(frozen=True, kw_only=True)
class FieldRecipe:
    """How long, from which examples, kept where: `folder` holds checkpoint, log and weights."""

    examples: Path
    folder: Path
    steps: int
    seed: int = 0


def train_field(recipe: FieldRecipe, seconds: float = math.inf) -> FieldNet:
    """Train until `steps` steps are done or the time is up; goes on from the last checkpoint."""
    torch.manual_seed(recipe.seed)
    net = FieldNet()
    optimizer = torch.optim.AdamW(net.parameters(), LEARNING_RATE, weight_decay=WEIGHT_DECAY)
    kept = recipe.folder / "checkpoint.pt"
    first = 0
    if kept.exists():
        state = torch.load(kept, weights_only=True)
        net.load_state_dict(state["net"])
        optimizer.load_state_dict(state["optimizer"])
        first = state["step"]
    started, recent = time.monotonic(), list[dict[str, float]]()
    for step in range(first, recipe.steps):
        recent.append(_step(net, optimizer, recipe, step))
        done = step + 1 == recipe.steps or time.monotonic() - started > seconds
        if (step + 1) % LOGGED_EVERY == 0:
            _log(recipe.folder, step + 1, recent)
            recent.clear()
        if (step + 1) % KEPT_EVERY == 0 or done:
            keep(kept, {"net": net.state_dict(), "optimizer": optimizer.state_dict(),
                        "step": step + 1})  # fmt: skip
        if done:
            break
    return net


def _step(
    net: FieldNet, optimizer: torch.optim.Optimizer, recipe: FieldRecipe, step: int
) -> dict[str, float]:
    """One step on one scan: which one, and how it is shown, follow from seed and step."""
    rng = np.random.default_rng([recipe.seed, step])
    paths = sorted(recipe.examples.glob("*.npz"))
    example = FieldExample.read(paths[rng.integers(len(paths))])
    batch = Batch.of(lesson_of(example.shown(rng), rng))
    for group in optimizer.param_groups:
        group["lr"] = rate_at(step, recipe.steps)
    losses = losses_of(net(batch.features, batch.tables), batch)
    loss = sum((weight * losses[name] for name, weight in LOSS_WEIGHT.items()), torch.zeros(()))
    optimizer.zero_grad()
    loss.backward()  # type: ignore[no-untyped-call]
    nn.utils.clip_grad_norm_(net.parameters(), 1.0)
    if torch.isfinite(loss):
        optimizer.step()
    return {name: float(value.detach()) for name, value in losses.items()}


def rate_at(step: int, steps: int) -> float:
    """The learning rate: a warm-up, then a half cosine."""
    cosine = 0.5 * (1 + math.cos(math.pi * step / steps))
    return LEARNING_RATE * min(1.0, (step + 1) / WARM_UP_STEPS) * (cosine + LAST_RATE)


def _log(folder: Path, step: int, recent: list[dict[str, float]]) -> None:
    row: dict[str, Any] = {"step": step, "at": time.strftime("%H:%M:%S")}
    row |= {name: round(float(np.nanmean([one[name] for one in recent])), 4) for name in recent[0]}
    with (folder / "log.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")


def keep(path: Path, state: dict[str, Any]) -> None:
    """Write a checkpoint, whole or not at all."""
    import io

    held = io.BytesIO()
    torch.save(state, held)
    write_bytes(path, held.getvalue())
