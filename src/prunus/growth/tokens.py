"""Threads in pieces as long as a finger is wide, and what a network is told of each for a foot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.field.votes import Threads, cover
from prunus.geometry.vectors import unit
from prunus.model import Floats, Ints, Role

TOKEN_M = 0.06
"""A token is made of nodes so near to its middle that run the same way."""
FREQUENCIES = np.pi / 2 * np.array([0.5, 1, 2, 4])
"""Of the sines and cosines of a place, a metre."""
FARTHEST_M = 4.0
"""Places farther off in a direction are told alike,"""
COSTLIEST = 4.0
"""and so are ways that cost more."""
PLACE_M, RADIUS_M, VOTES_LOG = 1.5, 0.01, 3.0
"""What counts as 1 of a place, as 0 of the logarithm of a radius, and as 1 of that of votes."""
FEATURES = 3 + 3 * 2 * len(FREQUENCIES) + len(Role) + 3 + 2 + 6 + 2 + 4


@dataclass(frozen=True, eq=False, kw_only=True)
class Tokens:
    """Tokens (T) of threads, each the mean of its nodes weighted by votes.

    xyz (T, 3); role (T, 6); toward_foot (T, 3), unit; radius (T,), metres; votes (T,), summed;
    of_node (N,), the token of each node; cost (F, T), what its wood costs each foot at places
    feet (F, 3), at most `COSTLIEST`.
    """

    xyz: Floats
    role: Floats
    toward_foot: Floats
    radius: Floats
    votes: Floats
    of_node: Ints
    feet: Floats
    cost: Floats

    @classmethod
    def of(cls, threads: Threads, feet: Ints, cost: Floats) -> Tokens:
        """The tokens of threads for feet (F,), and what each node costs each of them (F, N)."""
        token = cover(threads.xyz, threads.toward_foot, threads.votes, TOKEN_M)
        votes = np.asarray(np.bincount(token, threads.votes), np.float64)

        def mean(values: Floats) -> Floats:
            sums = [np.bincount(token, threads.votes * column) for column in values.T]
            return np.asarray(np.column_stack(sums) / votes[:, None])

        return cls(
            xyz=mean(threads.xyz),
            role=mean(threads.role),
            toward_foot=unit(mean(threads.toward_foot)),
            radius=mean(threads.radius[:, None])[:, 0],
            votes=votes,
            of_node=token,
            feet=threads.xyz[feet],
            cost=mean(np.minimum(cost, COSTLIEST).T).T,
        )

    def near(self, foot: int, most: int) -> Ints:
        """The rows of the tokens nearest to the upright over a foot, so many at most."""
        aside = np.linalg.norm(self.xyz[:, :2] - self.feet[foot, :2], axis=1)
        return np.sort(np.argsort(aside, kind="stable")[:most])

    def shown(self, foot: int, rows: Ints) -> dict[str, Floats]:
        """What the network is shown of tokens for one of the feet, by the names of its inputs."""
        xyz = (self.xyz[rows] - self.feet[foot]).astype(np.float32)
        return {"features": self.features(foot, rows), "xyz": xyz}

    def features(self, foot: int, rows: Ints) -> Floats:
        """What is told of tokens for one of the feet (T, `FEATURES`), which has others beside it.

        Where each lies from the foot and how it looks; what it costs this foot, and that of the
        others which it costs least; how its direction fits to either.
        """
        others = np.delete(self.cost, foot, axis=0)[:, rows]
        rival = np.delete(self.feet, foot, axis=0)[others.argmin(axis=0)]
        place, way = self.xyz[rows] - self.feet[foot], self.toward_foot[rows]
        to_rival = np.clip(rival - self.xyz[rows], -FARTHEST_M, FARTHEST_M)
        own, other = self.cost[foot, rows], others.min(axis=0)
        waves = [wave(place * rate) for rate in FREQUENCIES for wave in (np.sin, np.cos)]
        columns = [
            np.clip(place, -FARTHEST_M, FARTHEST_M) / PLACE_M, *waves, self.role[rows], way,
            np.log(np.maximum(self.radius[rows], 1e-3) / RADIUS_M),
            np.log(np.maximum(self.votes[rows], 0.1)) / VOTES_LOG,
            own, np.sqrt(own), other, np.sqrt(other), np.clip(own - other, -1, 1),
            np.sign(own - other), -_cosine(place, way), np.linalg.norm(place[:, :2], axis=1),
            to_rival / PLACE_M, _cosine(to_rival, way),
        ]  # fmt: skip
        return np.column_stack(columns).astype(np.float32)


def _cosine(place: Floats, way: Floats) -> Floats:
    """The cosines (T,) between places (T, 3) and unit directions (T, 3)."""
    length = np.linalg.norm(place, axis=1)
    return np.asarray((place * way).sum(axis=1) / np.maximum(length, 1e-6))
