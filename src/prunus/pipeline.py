"""The story on one page: a point cloud in, a labelled skeleton out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from prunus.errors import NoTreeError, PrunusError
from prunus.frames.diagnosis import explaining
from prunus.frames.plausible import Evidence
from prunus.method import Method
from prunus.model import Floats, PointCloud
from prunus.model.arrays import frozen
from prunus.params import Parameters, checked_params, checked_seed
from prunus.result import Result, Seconds

if TYPE_CHECKING:
    from prunus.paper.confidence import EdgeScorer


def skeletonize(
    cloud: PointCloud | ArrayLike,
    base: ArrayLike | None = None,
    params: Parameters | Mapping[str, Any] | None = None,
    seed: int = 0,
    scorer: EdgeScorer | None = None,
    method: Method | None = None,
) -> Result:
    """Turn a cloud into a labelled skeleton.

    cloud: points (P, 3) in metres, Z up and X along the row; for another frame a `PointCloud`.
    base: a point (3,) where the trunk meets the ground, in the frame of the input; None finds it.
    params: also as nested dicts. scorer: your own, which has to keep to its range. method: one with
    a part replaced; None: that of the parameters.
    Same input, parameters and seed give the same skeleton, bit for bit.
    Raises PrunusError naming the argument that is wrong; NoTreeError where the cloud holds no tree
    that can be followed, with the reason and what to try.
    """
    cloud = cloud if isinstance(cloud, PointCloud) else PointCloud.from_xyz(cloud)
    with explaining(cloud):
        return _judged(follow(cloud, base, params, seed, scorer, method))


def follow(
    cloud: PointCloud,
    base: ArrayLike | None = None,
    params: Parameters | Mapping[str, Any] | None = None,
    seed: int = 0,
    scorer: EdgeScorer | None = None,
    method: Method | None = None,
) -> Result:
    """What `skeletonize` finds, tree or not: for experiments, which count the failures too."""
    at = None if base is None else cloud.to_input.inverse().apply(_point(base))
    params, seed = checked_params(params), checked_seed(seed)
    method = Method.of(params) if method is None else method
    method = method if scorer is None else method.scored_by(scorer)
    rng, seconds = np.random.default_rng(seed), Seconds()
    evidence = method.evidence(cloud, at, params, rng, seconds)
    found = method.tree(evidence, params, rng, seconds)
    return Result(
        in_house=found.skeleton,
        graph=found.graph,
        score=found.score,
        history=found.history,
        seconds=seconds,
        params=params,
        seed=seed,
        warnings=found.warnings,
        notes=found.notes,
        scan=cloud,
        isolated=found.isolated,
        told=found.told,
    )


def _judged(result: Result) -> Result:
    """The result with what is doubtful about it; NoTreeError where it is no tree."""
    evidence = Evidence.of(result)
    try:
        evidence.check()
    except NoTreeError as error:
        if result.isolated is None:
            raise
        raise NoTreeError(
            f"{error}; {result.isolated.removed:.0%} of the scan was left out as no part of this "
            "tree (--no-isolate keeps it, --base says where the tree stands)"
        ) from error
    return replace(result, warnings=[*evidence.doubts(), *result.warnings])


def _point(base: ArrayLike) -> Floats:
    point = frozen(base, np.float64, (3,), "base")
    if not np.isfinite(point).all():
        raise PrunusError(f"base: {point}; expected three finite numbers x, y, z")
    return point
