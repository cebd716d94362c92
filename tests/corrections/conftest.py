"""A scan in a file, quick to skeletonize, and a work folder."""

from pathlib import Path

import numpy as np
import pytest

from prunus.corrections import Settings, Work
from prunus.corrections.state import State
from prunus.io.clouds import write_cloud
from prunus.pipeline import skeletonize
from prunus.simulate import simulate_scan
from tests.corrections.trees import FAR

QUICK = Settings(frame="z-up")


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
    from prunus.intake import open_scan

    return State.of(skeletonize(open_scan(scan_file, "z-up").cloud))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "work" / "clean"


@pytest.fixture
def opened(scan_file: Path, folder: Path) -> Work:
    with Work.open(scan_file, folder, QUICK) as work:
        yield work
