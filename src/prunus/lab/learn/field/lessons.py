"""What the network of the point field learns on one scan, and its losses."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from prunus.field.network import COLUMNS, OFFSET_M, RADIUS_M, TABLES, tables_of
from prunus.field.voxels import LEVELS
from prunus.lab.learn.export import Named, onnx_of
from prunus.lab.learn.field.examples import FieldExample, Lesson, lesson_of
from prunus.lab.learn.field.net import Tables
from prunus.lab.simulate.wide.points import UNKNOWN_ROLE, UNTOLD
from prunus.model import Role

CLASS_WEIGHT = (1.5, 1.5, 1.0, 1.3, 1.3, 1.0)  # of the roles, in the order of `Role`
LOSS_WEIGHT = {"role": 1.0, "offset": 0.7, "log_radius": 0.2, "toward_foot": 0.5}
LEAST_RADIUS_M = 0.001
FARTHEST = 4.0  # longer errors of an offset (in 3 cm) count no more


def field_losses(
    net: nn.Module, path: Path, rng: np.random.Generator, device: torch.device
) -> tuple[Tensor, dict[str, Tensor]]:
    """The loss on the example in a file, shown in one way, and what it is made of."""
    batch = Batch.of(lesson_of(FieldExample.read(path).shown(rng), rng), device)
    losses = losses_of(net(batch.features, batch.tables), batch)
    loss = sum(weight * losses[name] for name, weight in LOSS_WEIGHT.items())
    assert isinstance(loss, Tensor)
    return loss, losses


class _OneByOne(Named):
    """The network with its tables one by one, in the order of `TABLES`."""

    def forward(self, *inputs: Tensor) -> Tensor:
        """The outputs (V, 13)."""
        features, *tables = inputs
        neighbours, rest = tables[:LEVELS], tables[LEVELS:]
        outputs: Tensor = self.net(
            features, Tables(tuple(neighbours), tuple(rest[::2]), tuple(rest[1::2]))
        )
        return outputs


def field_onnx(net: nn.Module, path: Path) -> bytes:
    """The file of a network; walks over the voxels of the example in a file."""
    voxels = lesson_of(FieldExample.read(path)).voxels
    shown = {"features": voxels.features(), **tables_of(voxels)}
    return onnx_of(
        _OneByOne(net),
        {name: torch.from_numpy(shown[name]) for name in ("features", *TABLES)},
        "outputs",
    )


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
