"""A work folder."""

from pathlib import Path

import pytest

from prunus.session import Settings, Work

QUICK = Settings(frame="z-up")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "work" / "clean"


@pytest.fixture
def opened(scan_file: Path, folder: Path) -> Work:
    with Work.open(scan_file, folder, QUICK) as work:
        yield work
