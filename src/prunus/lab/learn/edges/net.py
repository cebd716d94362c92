"""The edge network of the paper (Appendix A).

It gives seven numbers an edge: two for validity, five for the category of a valid edge. B edges.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from prunus.paper.kernels.frames import HIGH, WIDE

VALIDITY = 2
OUTPUTS = 7


class PaperNet(nn.Module):
    """Appendix A: image -> 6-vector; joined to the description; three hidden layers -> 7.

    The edge image is defined up to flips of either axis: training flips it at random, and the
    answer is the mean over all four flips, so that they cannot matter.
    """

    def __init__(self) -> None:
        super().__init__()
        self.image = nn.Sequential(
            *pair(1, 16), nn.BatchNorm2d(16), nn.MaxPool2d(2),
            *pair(16, 32), nn.BatchNorm2d(32), nn.MaxPool2d(2),
            *pair(32, 64), nn.Flatten(),
            nn.Linear(64 * (HIGH // 4) * (WIDE // 4), 64), nn.ReLU(), nn.Linear(64, 6),
        )  # fmt: skip
        self.joined = nn.Sequential(
            nn.Linear(10, 128), nn.ReLU(), nn.Dropout(0.25),
            nn.Linear(128, 128), nn.ReLU(), nn.Dropout(0.25),
            nn.Linear(128, 128), nn.ReLU(), nn.Linear(128, OUTPUTS),
        )  # fmt: skip

    def once(self, images: Tensor, described: Tensor) -> Tensor:
        """Seven numbers (B, 7) from images (B, HIGH, WIDE) as they lie, and descriptions (B, 4)."""
        found: Tensor = self.joined(torch.cat([self.image(images[:, None]), described], dim=1))
        return found

    def forward(self, images: Tensor, described: Tensor) -> Tensor:
        """The mean of `once` over the four flips; in training `once`."""
        if self.training:
            return self.once(images, described)
        flips = [images, images.flip(1), images.flip(2), images.flip(1, 2)]
        return sum(self.once(flip, described) for flip in flips) / 4  # type: ignore[return-value]


def pair(inward: int, outward: int) -> list[nn.Module]:
    """Two 3 x 3 convolutions with ReLU."""
    first = nn.Conv2d(inward, outward, 3, padding=1)
    return [first, nn.ReLU(), nn.Conv2d(outward, outward, 3, padding=1), nn.ReLU()]


class Calibrated(nn.Module):
    """A trained network as it ships: confidence (E,) and category (E, 5), as probabilities.

    The log odds of the network, trained on classes made even, are stretched and shifted to the
    share of valid edges that clouds have.
    """

    def __init__(self, net: nn.Module, stretch: float, shift: float) -> None:
        super().__init__()
        self.net, self.stretch, self.shift = net, stretch, shift

    def forward(self, *inputs: Tensor) -> tuple[Tensor, Tensor]:
        """Confidence and category."""
        found = self.net(*inputs)
        odds = self.stretch * (found[:, 1] - found[:, 0]) + self.shift
        return torch.sigmoid(odds), torch.softmax(found[:, VALIDITY:], dim=1)
