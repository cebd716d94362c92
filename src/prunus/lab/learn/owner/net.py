"""The network that tells whose wood is, in torch: what is trained, and what is exported to ONNX.

A transformer over the tokens around one foot. The farther two of them lie apart, the less each
looks at the other; how much less is learned for each head.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

from prunus.growth.tokens import FEATURES

WIDTH, HEADS, BLOCKS, HEAD = 64, 4, 4, 32
FARTHER = 4.0  # log odds of looking at what lies a metre farther, for a slope of 1
STEEPEST = 3.0  # the slopes of the heads as training begins, from 0 on


class Block(nn.Module):
    """Attention, and a perceptron, around which the input goes on."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.looks_norm, self.thinks_norm = nn.LayerNorm(width), nn.LayerNorm(width)
        self.looks, self.takes = nn.Linear(width, 3 * width), nn.Linear(width, width)
        self.thinks = nn.Sequential(
            nn.Linear(width, 2 * width), nn.GELU(), nn.Linear(2 * width, width)
        )
        self.slope = nn.Parameter(torch.linspace(0.0, STEEPEST, heads).view(-1, 1, 1))

    def forward(self, x: Tensor, apart: Tensor) -> Tensor:
        """(T, width) to (T, width); `apart` (T, T) is how far off the tokens lie."""
        width = x.shape[1]
        split = self.looks(self.looks_norm(x)).view(-1, 3, self.heads, width // self.heads)
        query, key, value = split.permute(1, 2, 0, 3)
        likeness = query @ key.transpose(1, 2) / math.sqrt(width // self.heads)
        attention = (likeness - self.slope * apart).softmax(dim=2)
        x = x + self.takes((attention @ value).transpose(0, 1).reshape(-1, width))
        outer: Tensor = x + self.thinks(self.thinks_norm(x))
        return outer


class OwnerNet(nn.Module):
    """Features (T, `FEATURES`) and places (T, 3) of tokens to the logit (T,) that each is owned."""

    def __init__(self) -> None:
        super().__init__()
        self.enter = nn.Sequential(nn.Linear(FEATURES, WIDTH), nn.GELU(), nn.Linear(WIDTH, WIDTH))
        self.blocks = nn.ModuleList(Block(WIDTH, HEADS) for _ in range(BLOCKS))
        self.tell = nn.Sequential(
            nn.LayerNorm(WIDTH), nn.Linear(WIDTH, HEAD), nn.GELU(), nn.Linear(HEAD, 1)
        )

    def forward(self, features: Tensor, xyz: Tensor) -> Tensor:
        """The logits (T,)."""
        squared = ((xyz[:, None] - xyz[None]) ** 2).sum(dim=2)
        apart = FARTHER * torch.sqrt(squared + 1e-6)
        x = self.enter(features)
        for block in self.blocks:
            x = block(x, apart)
        logits: Tensor = self.tell(x)[:, 0]
        return logits
