"""The default chain, report and cuts included, never loads a compiler."""

import subprocess
import sys
from pathlib import Path

import numpy as np

from prunus.io.clouds.cloud_file import write_cloud
from tests.growth.drawn import TEXTBOOK, surface_of

CHAIN = """
import sys
from prunus.cli import app
for words in (
    ["skeletonize", "tree.ply", "-o", "out", "--traits", "--frame", "z-up"],
    ["cuts", "out/skeleton.json", "-o", "plan.json"],
    ["isolate", "tree.ply", "-o", "alone.ply", "--frame", "z-up"],
    ["convert", "out/refined.json", "tree.glb"],
    ["cuts", "tree.ply", "--frame", "auto"],
):
    app(words, standalone_mode=False)
loaded = {name.partition(".")[0] for name in sys.modules}
print("loaded:", sorted(loaded & {"numba", "llvmlite", "torch"}))
"""


def test_nothing_of_the_default_loads_a_compiler(tmp_path: Path) -> None:
    write_cloud(tmp_path / "tree.ply", surface_of(TEXTBOOK, np.random.default_rng(0)))
    done = subprocess.run(
        [sys.executable, "-c", CHAIN], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "loaded: []"
