"""What many tests share: a simulated tree with its scan, and the real scan where there is one."""

import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from prunus.editing import State
from prunus.frames.scan import open_scan
from prunus.io.clouds.cloud_file import write_cloud
from prunus.lab.simulate import Scan, simulate_scan
from prunus.model import PointCloud, Skeleton
from prunus.pipeline import skeletonize
from tests.editing.trees import FAR

# A check that fails for one and passes for the next helps nobody: CI always draws the same.
settings.register_profile("ci", derandomize=True, deadline=None)
if "CI" in os.environ:
    settings.load_profile("ci")

REAL = Path(__file__).resolve().parents[2] / "shared" / "data" / "ufo_tree0.ply"


@cache
def field_scan(seed: int) -> Scan:
    """A field scan with the truth of every point."""
    return simulate_scan(seed)


@cache
def simulated(seed: int, points: int = 20_000) -> tuple[Skeleton, PointCloud]:
    """A true tree and the points of it in a field scan."""
    scan = field_scan(seed)
    return scan.truth, scan.target_cloud().sample(points, np.random.default_rng(seed))


@pytest.fixture(scope="session")
def scanned() -> tuple[Skeleton, PointCloud]:
    return simulated(4)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(0)


@pytest.fixture(scope="session")
def real_scan() -> Path:
    if not REAL.exists():
        pytest.skip("the real scan lies in ../shared, which is absent here")
    return REAL


@pytest.fixture(scope="session")
def scan_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A clean scan of a simulated tree, far from the origin."""
    path = tmp_path_factory.mktemp("scans") / "clean.ply"
    cloud = simulate_scan(4, "clean").target_cloud().sample(5000, np.random.default_rng(0))
    write_cloud(path, cloud.to_input.apply(cloud.xyz) + FAR)
    return path


@pytest.fixture(scope="session")
def machine(scan_file: Path) -> State:
    """What the machine finds in it."""
    return State.of(skeletonize(open_scan(scan_file, "z-up").cloud))
