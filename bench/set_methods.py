"""The chains that are judged, by name: a cloud and perhaps a base in, a skeleton or none out."""

from __future__ import annotations

import importlib
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from prunus import skeletonize
from prunus.errors import PrunusError
from prunus.growth.chain import Votes
from prunus.growth.ways import cheapest
from prunus.method import Method as Chain
from prunus.model import Bools, Floats, PointCloud, Skeleton
from prunus.params import Parameters


@dataclass(frozen=True, eq=False)
class Found:
    """A skeleton in the frame of the input, and which points (P,) were taken for the tree's.

    Without `kept` nothing is known of it.
    """

    skeleton: Skeleton
    kept: Bools | None = None


Method = Callable[[PointCloud, Floats | None], "Skeleton | Found | None"]


def _default(cloud: PointCloud, base: Floats | None) -> Found:
    return _skeletonized(cloud, base, Parameters())


def _by_cost(cloud: PointCloud, base: Floats | None) -> Found:
    """The default, but of which tree wood is tells cost alone."""
    chain = replace(Chain.default(), evidence=Votes(own=cheapest))
    return _skeletonized(cloud, base, Parameters(), chain)


def _paper(cloud: PointCloud, base: Floats | None) -> Found:
    return _skeletonized(cloud, base, Parameters.paper())


def _skeletonized(
    cloud: PointCloud, base: Floats | None, params: Parameters, chain: Chain | None = None
) -> Found:
    result = skeletonize(cloud, base, params, method=chain)
    every = np.ones(len(cloud), np.bool_)
    return Found(result.skeleton, every if result.isolated is None else result.isolated.target)


METHODS: dict[str, Method] = {"default": _default, "by_cost": _by_cost, "paper": _paper}


def method_of(name: str) -> Method:
    """A method of the table, or any `module:function` of cloud and base."""
    if name in METHODS:
        return METHODS[name]
    if ":" not in name:
        sys.exit(
            f"bench.sets: unknown method {name!r}; expected {', '.join(METHODS)} or m:function"
        )
    return _imported(name)


def _imported(name: str) -> Callable[..., Skeleton]:
    module, _, function = name.partition(":")
    try:
        found: Callable[..., Skeleton] = getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError) as error:
        sys.exit(f"bench.sets: no method {name}: {error}")
    return found


def tried(method: Method, xyz: Floats, base: Floats | None) -> tuple[Found | None, float]:
    """What a method makes of points, None where it refuses them, and its CPU seconds."""
    cloud = PointCloud.from_xyz(xyz)
    before = _cpu_s()
    try:
        found = method(cloud, base)
    except PrunusError as error:
        print(f"  refused: {error}", file=sys.stderr)
        found = None
    spent = _cpu_s() - before
    return (Found(found) if isinstance(found, Skeleton) else found), spent


def _cpu_s() -> float:
    """CPU seconds of this process, and of the processes that it started and that have ended."""
    children = os.times()
    return time.process_time() + children.children_user + children.children_system
