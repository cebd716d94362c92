"""The sparse U-Net of the point field, in torch: what is trained, and what is exported to ONNX.

Five levels of voxels, 2 to 32 cm. A convolution gathers the 27 neighbours of each voxel and
multiplies by one matrix; the way down takes the mean of up to eight voxels, the way up copies.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import torch
from torch import Tensor, nn

from prunus.field.network import COLUMNS
from prunus.field.voxels import FEATURES, NEIGHBOURS, Level

CHANNELS = (24, 32, 48, 64, 64)
HEAD = 48


class Tables(NamedTuple):
    """Of each level: neighbours (V, 27), parent (V,), children (W, 8); the last has no others."""

    neighbours: tuple[Tensor, ...]
    parent: tuple[Tensor, ...]
    children: tuple[Tensor, ...]

    @classmethod
    def of(cls, levels: Sequence[Level]) -> Tables:
        """The tables of a pyramid of voxels."""
        return cls(
            tuple(torch.from_numpy(level.neighbours) for level in levels),
            tuple(torch.from_numpy(level.parent) for level in levels[:-1]),
            tuple(torch.from_numpy(level.children) for level in levels[:-1]),
        )

    def to(self, device: torch.device | None) -> Tables:
        """The tables on a device."""
        return Tables(*(tuple(table.to(device) for table in tables) for tables in self))


def padded(x: Tensor) -> Tensor:
    """The rows (V, C) and a row of zeros, which stands for an empty voxel."""
    return torch.cat([x, x.new_zeros(1, x.shape[1])])


class GatherProduct(torch.autograd.Function):
    """x (V, C) gathered by neighbours (V, 27), times a matrix (27 C, D).

    The table is symmetric (if a is the k-th neighbour of b, b is the (26 - k)-th of a), so the
    gradient is a gather and a product too, without the slow scatter that autograd would take.
    """

    @staticmethod
    def forward(ctx: Any, x: Tensor, weight: Tensor, neighbours: Tensor) -> Tensor:
        """The product (V, D)."""
        ctx.save_for_backward(x, weight, neighbours)
        product: Tensor = padded(x)[neighbours].flatten(1) @ weight
        return product

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, Tensor, None]:
        """The gradients of x and of the matrix."""
        x, weight, neighbours = ctx.saved_tensors
        of_weight = padded(x)[neighbours].flatten(1).T @ gradient
        back = weight.view(len(NEIGHBOURS), x.shape[1], -1).flip(0).transpose(1, 2)
        of_x = padded(gradient)[neighbours].flatten(1) @ back.flatten(0, 1)
        return of_x, of_weight, None


class Convolution(nn.Module):
    """A 3 x 3 x 3 convolution over occupied voxels."""

    def __init__(self, width: int, out: int) -> None:
        super().__init__()
        taps = len(NEIGHBOURS)
        # About a third of the neighbours are occupied: He's scale for those.
        self.weight = nn.Parameter(torch.randn(taps * width, out) * (2 / (taps / 3 * width)) ** 0.5)
        self.bias = nn.Parameter(torch.zeros(out))

    def forward(self, x: Tensor, neighbours: Tensor) -> Tensor:
        """(V, width) to (V, out)."""
        if torch.onnx.is_in_onnx_export():
            return padded(x)[neighbours].flatten(1) @ self.weight + self.bias
        product: Tensor = GatherProduct.apply(x, self.weight, neighbours)  # type: ignore[no-untyped-call]
        return product + self.bias


class Residual(nn.Module):
    """Two convolutions with layer norm, around which the input goes on."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.first, self.second = Convolution(width, width), Convolution(width, width)
        self.first_norm, self.second_norm = nn.LayerNorm(width), nn.LayerNorm(width)

    def forward(self, x: Tensor, neighbours: Tensor) -> Tensor:
        """(V, width) to (V, width)."""
        inner = torch.relu(self.first_norm(self.first(x, neighbours)))
        outer: Tensor = x + self.second_norm(self.second(inner, neighbours))
        return outer


class FieldNet(nn.Module):
    """Features (V, `FEATURES`) of the finest voxels to the columns of `COLUMNS`, side by side."""

    def __init__(self, channels: Sequence[int] = CHANNELS) -> None:
        super().__init__()
        finer, coarser = channels[:-1], channels[1:]
        self.enter = nn.Linear(FEATURES, channels[0])
        self.stem = Convolution(channels[0], channels[0])
        self.down = nn.ModuleList(Residual(width) for width in channels)
        self.narrow = nn.ModuleList(nn.Linear(a, b) for a, b in zip(finer, coarser, strict=True))
        self.widen = nn.ModuleList(nn.Linear(a + b, a) for a, b in zip(finer, coarser, strict=True))
        self.up = nn.ModuleList(Residual(width) for width in finer)
        self.head = nn.Sequential(
            nn.Linear(channels[0], HEAD), nn.ReLU(), nn.Linear(HEAD, sum(COLUMNS.values()))
        )

    def forward(self, features: Tensor, tables: Tables) -> Tensor:
        """The outputs (V, 13)."""
        x = torch.relu(self.stem(self.enter(features), tables.neighbours[0]))
        passed = []
        for level, block in enumerate(self.down):
            x = block(x, tables.neighbours[level])
            if level < len(self.narrow):
                passed.append(x)
                x = torch.relu(self.narrow[level](mean_of_children(x, tables.children[level])))
        for level in reversed(range(len(self.up))):
            joined = torch.cat([x[tables.parent[level]], passed[level]], dim=1)
            x = self.up[level](torch.relu(self.widen[level](joined)), tables.neighbours[level])
        outputs: Tensor = self.head(x)
        return outputs


def mean_of_children(x: Tensor, children: Tensor) -> Tensor:
    """The mean (W, C) of the rows of x (V, C) that each coarser voxel holds."""
    held = (children < x.shape[0]).sum(dim=1, keepdim=True)
    return padded(x)[children].sum(dim=1) / held
