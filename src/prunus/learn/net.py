"""The edge networks: the paper's (Appendix A) and ours.

Both give seven numbers an edge: two for validity, five for the category of a valid edge. Letters:
B or E edges, C channels, W edges met at one end, D width of a hidden layer.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from prunus.kernels.frames import HIGH, WIDE
from prunus.kernels.profiles import ALONG, AROUND, STEPS
from prunus.stages.context import EDGE_FEATURES, MEETING_FEATURES

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


class ContextNet(nn.Module):
    """Ours: each edge among the edges that it meets, some rounds of looking around.

    An edge starts from its profile (read both ways, so that its ends can be swapped) and features.
    In each round it hears from every edge that it meets, through a gate that knows how the two lie
    to each other; it keeps the mean and the strongest of what it hears.
    """

    ROUNDS = 5
    D = 64
    HEARD = 32

    def __init__(self) -> None:
        super().__init__()
        D, C = self.D, self.HEARD
        shape = ALONG * AROUND + STEPS * STEPS
        self.shape = nn.Sequential(
            nn.Linear(shape, 2 * D), nn.ReLU(), nn.Linear(2 * D, D), nn.ReLU(), nn.Linear(D, D)
        )
        self.edge = nn.Sequential(nn.Linear(D + EDGE_FEATURES, D), nn.ReLU(), nn.Linear(D, D))
        self.scale = nn.BatchNorm1d(EDGE_FEATURES)
        self.meeting = nn.Sequential(nn.Linear(MEETING_FEATURES, C), nn.ReLU(), nn.Linear(C, C))
        self.say = nn.ModuleList(nn.Linear(D, C) for _ in range(self.ROUNDS))
        self.hear = nn.ModuleList(
            nn.Sequential(nn.Linear(D + 2 * C, D), nn.ReLU(), nn.Linear(D, D))
            for _ in range(self.ROUNDS)
        )
        self.norm = nn.ModuleList(nn.LayerNorm(D) for _ in range(self.ROUNDS))
        self.last = nn.Sequential(
            nn.Linear(D, D), nn.ReLU(), nn.Dropout(0.1), nn.Linear(D, OUTPUTS)
        )

    def forward(
        self, profile: Tensor, bend: Tensor, edge: Tensor, met: Tensor, meeting: Tensor
    ) -> Tensor:
        """Seven numbers (E, 7) from the fields of a `stages.context.Context`."""
        there = torch.cat([profile.flatten(1), bend.flatten(1)], dim=1)
        back = torch.cat([profile.flip(1).flatten(1), bend.flip(1, 2).flatten(1)], dim=1)
        both = self.shape(there) + self.shape(back)
        state = self.edge(torch.cat([both, self.scale(edge)], dim=1))
        any_met = meeting[:, :, -1:]
        gate = self.meeting(meeting) * any_met
        count = any_met.sum(dim=1).clamp(min=1)
        where = met.clamp(min=0)
        for say, hear, norm in zip(self.say, self.hear, self.norm, strict=True):
            heard = say(norm(state))[where] * gate
            state = state + hear(
                torch.cat([state, heard.sum(dim=1) / count, heard.amax(dim=1)], dim=1)
            )
        found: Tensor = self.last(state)
        return found


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
