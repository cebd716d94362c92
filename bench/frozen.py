"""`python -m bench.frozen [SCAN ...] > before.txt`: digests of all that is written.

For refactoring: scans of six seeds with their truth, and by both methods skeleton, refined tree,
traits, mesh and plans of cuts, from the command line as users have them; SCAN: real ones too. Run
it before and after a change that must change nothing, and compare with `diff`. Digests are those
of one machine.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

SEED, TREES = 910_000, 2
SCANS = "hard", "clean", "any"
"""Raw scans of so many trees of each kind."""
NOT_OURS = {"seconds", "version", "prunus", "cpu_s", "wall_s", "created"}
"""Keys of JSON that differ from run to run, or from version to version."""


def main() -> None:
    """Print a digest a file."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        scans = [Path(name).resolve() for name in sys.argv[1:]]
        for kind in SCANS:
            _prunus("simulate", "-n", TREES, "--seed", SEED, "--scan", kind, "-o", home / kind)
            scans += sorted((home / kind).glob("**/*.ply"))
        for scan in scans:
            for method in ("default", "paper"):
                own = scan.relative_to(home) if scan.is_relative_to(home) else Path(scan.name)
                _run(scan, method, home / method / own.with_suffix(""))
        for path in sorted(home.rglob("*")):
            if path.is_file() and path.suffix not in {".html", ".toml"}:
                print(_digest(path, home), path.relative_to(home))


def _run(scan: Path, method: str, out: Path) -> None:
    named = ["--params", "paper"] if method == "paper" else []
    _prunus("skeletonize", scan, *named, "--traits", "--no-report", "-o", out)
    if not (out / "skeleton.json").exists():
        return
    _prunus("cuts", scan, *named, "-o", out / "of_scan.json")
    for name in ("skeleton.json", "refined.json"):
        _prunus("cuts", out / name, "-o", out / f"of_{name}")
    _prunus("convert", out / "refined.json", out / "tree.obj")


def _prunus(*words: object) -> None:
    command = [sys.executable, "-m", "prunus.cli", *map(str, words)]
    done = subprocess.run(command, cwd=tempfile.gettempdir(), capture_output=True, text=True)
    if done.returncode:
        print("status", done.returncode, words[0], Path(str(words[1])).parent.name)


def _digest(path: Path, home: Path) -> str:
    content = path.read_bytes().replace(str(home).encode(), b"")
    if path.suffix == ".json":
        content = json.dumps(_ours(json.loads(content)), sort_keys=True).encode()
    return hashlib.sha256(content).hexdigest()[:16]


def _ours(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _ours(one) for key, one in value.items() if key not in NOT_OURS}
    return [_ours(one) for one in value] if isinstance(value, list) else value


if __name__ == "__main__":
    main()
