"""The wheel as a stranger gets it: built, looked into, used alone on every Python of this machine.

    make wheel

The sdist is built, the wheel from it, and both are asked what the index asks. For each Python, once
with the newest and once with the lowest versions that pyproject.toml admits, a bare environment is
made, and a scan goes through the commands there: with an empty home, no compiled kernels, in a
folder outside the clone. Then that environment gets `prunus[all]`. Compiling takes a minute: with
the lowest versions a scan goes through on the lowest Python alone, the others load them; they
differ only where a Python has no wheels of them. Training is left out: torch is larger than all
else. A Python that is absent is said; that its wheels exist is asked all the same.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
import time
import zipfile
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from shutil import rmtree
from subprocess import DEVNULL, PIPE, STDOUT, CalledProcessError, TimeoutExpired
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
DIST = ROOT / "dist"
REAL = ROOT.parent / "shared" / "data" / "ufo_tree0.ply"
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
NEWEST, LOWEST = "highest", "lowest-direct"  # uv's words
PATIENCE_S = 900  # the longest that one command may take
REPORT_BYTES = 1_000_000  # a report holds the library that draws it
WHEELS_ONLY = ("--only-binary", ":all:")
TRAINING = {"torch", "onnx"}
EXTRAS = TRAINING | {"viser", "rosbags", "PIL", "pyarrow"}

EVERY_MODULE = """
import importlib, pkgutil, sys, prunus
assert prunus.__file__.startswith(sys.prefix), prunus.__file__
for name in prunus.__all__:
    getattr(prunus, name)
for module in pkgutil.walk_packages(prunus.__path__, "prunus."):
    try:
        importlib.import_module(module.name)
    except ModuleNotFoundError as error:
        print(error.name)
"""
"""Loads every public name and every module; prints the packages that are missing."""


class WheelError(Exception):
    """What is wrong with the wheel, for a person."""


def run(*words: str | Path, **where: Any) -> str:
    """What a command prints; raises WheelError with the end of that where it fails."""
    command = [str(word) for word in words]
    pipes: Any = {"stdin": DEVNULL, "stdout": PIPE, "stderr": STDOUT, "text": True}
    try:
        return str(subprocess.run(command, check=True, timeout=PATIENCE_S, **pipes, **where).stdout)
    except (CalledProcessError, TimeoutExpired) as error:
        raise WheelError(f"{error}\n{(error.output or '')[-3000:]}") from error


def uv(*words: str | Path) -> str:
    """Run uv; it sees the Pythons of pyenv too."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    path = os.pathsep.join([*map(str, pyenv.glob("versions/*/bin")), os.environ["PATH"]])
    env = {**os.environ, "PATH": path}
    return run(sys.executable, "-m", "uv", "--quiet", *words, cwd=ROOT, env=env)


def build() -> Path:
    """The wheel in dist/, made from the sdist beside it; both hold what they should."""
    rmtree(DIST, ignore_errors=True)
    run(sys.executable, "-m", "build", "--installer", "uv", "-o", DIST, ROOT)
    (wheel,), (sdist,) = DIST.glob("*.whl"), DIST.glob("*.tar.gz")
    run(sys.executable, "-m", "twine", "check", "--strict", wheel, sdist)
    holds_the_source("the wheel", zipfile.ZipFile(wheel).namelist())
    with tarfile.open(sdist) as packed:
        names = [name.partition("/")[2] for name in packed.getnames()]
    holds_the_source("the sdist", [name[4:] for name in names if name.startswith("src/")])
    return wheel


def holds_the_source(what: str, names: list[str]) -> None:
    """Raise WheelError unless the files are those of src/, every kind of them, and no more."""
    has = {name for name in names if ".dist-info/" not in name}
    files = [path for path in (ROOT / "src").rglob("*") if path.is_file()]
    source = {p.relative_to(ROOT / "src").as_posix() for p in files if "__pycache__" not in p.parts}
    if has != source:
        raise WheelError(f"{what} lacks {sorted(source - has)}; it should not have {has - source}")


@dataclass(frozen=True)
class Trial:
    """One Python, with the newest or the lowest versions of all that prunus needs."""

    python: str
    versions: str
    wheel: Path

    def run(self) -> str:
        """Install the wheel and use it; what to say of that."""
        began = time.monotonic()
        with TemporaryDirectory() as folder:
            if not has_python(self.python):
                pins = self.pins(Path(folder), "all")
                self.compile(*WHEELS_ONLY, "-c", pins, "--extra", "all")
                return f"{self.name}: not on this machine; the wheels it needs exist"
            self.use(Path(folder))
        what = "works" if self.compiles else "loads"
        return f"{self.name}: {what} ({time.monotonic() - began:.0f} s)"

    @property
    def name(self) -> str:
        """What the trial is called."""
        return f"Python {self.python}, {'newest' if self.versions == NEWEST else 'lowest'} versions"

    @property
    def compiles(self) -> bool:
        """Whether a scan goes through, which takes a minute to compile, or all is only loaded."""
        return self.versions == NEWEST or self.python == PYTHONS[0]

    def use(self, folder: Path) -> None:
        """Use the wheel alone, then with its extras."""
        stranger = Stranger(folder / "venv" / "bin", folder / "home", folder / "work")
        stranger.home.mkdir()
        stranger.work.mkdir()
        uv("venv", "-p", self.python, "--no-python-downloads", folder / "venv")
        self.install(folder, "")
        stranger.lacks_at_most(EXTRAS)
        if self.compiles:
            stranger.walks_through()
        self.install(folder, "all")
        stranger.lacks_at_most(TRAINING)
        if self.compiles:
            stranger.uses_extras()

    def install(self, folder: Path, extra: str) -> None:
        """Install the wheel in the environment of a folder, at the versions of this trial."""
        what = f"prunus[{extra}] @ {self.wheel.as_uri()}"
        where = ("-p", folder / "venv" / "bin" / "python", "-c", self.pins(folder, extra))
        uv("pip", "install", *where, *WHEELS_ONLY, what)

    def pins(self, folder: Path, extra: str) -> Path:
        """A file with the versions of this trial, whether or not they have wheels."""
        pins = folder / f"pins{extra}.txt"
        pins.write_text(self.compile(*(("--extra", extra) if extra else ())))
        return pins

    def compile(self, *words: str | Path) -> str:
        """The versions that uv finds."""
        how = ("--resolution", self.versions, "--python-version", self.python)
        return uv("pip", "compile", *how, *words, "--no-header", "--no-annotate", "pyproject.toml")


def has_python(version: str) -> bool:
    """Whether this machine has a Python."""
    try:
        uv("python", "find", "--system", "--no-project", "--no-python-downloads", version)
    except WheelError:
        return False
    return True


@dataclass(frozen=True)
class Stranger:
    """One who has nothing but an environment: an empty home, an empty folder to work in."""

    bin: Path
    home: Path
    work: Path

    def runs(self, program: str, *words: str | Path) -> str:
        """What a program of the environment prints."""
        env = {"HOME": str(self.home), "PATH": os.defpath}
        return run(self.bin / program, *words, cwd=self.work, env=env)

    def lacks_at_most(self, packages: set[str]) -> None:
        """Load every public name and module; only these packages may be missing."""
        missing = {name.split(".")[0] for name in self.runs("python", "-c", EVERY_MODULE).split()}
        if missing - packages:
            raise WheelError(f"not declared: {sorted(missing - packages)}")

    def walks_through(self) -> None:
        """What the README shows first."""
        self.runs("prunus", "--help")
        self.runs("prunus", "demo", "-o", "demo")
        self.runs("prunus", "skeletonize", REAL if REAL.exists() else "demo/scan.ply", "-o", "tree")
        self.runs("prunus", "convert", "tree/skeleton.json", "tree.swc")
        self.runs("prunus", "cuts", "tree/skeleton.json", "-o", "plan.json")
        for name in ("demo/skeleton.json", "tree/skeleton.json", "tree.swc", "plan.json"):
            self.has(name, 1)
        self.has("tree/report.html", REPORT_BYTES)

    def uses_extras(self) -> None:
        """Parquet and a bag."""
        self.runs("prunus", "skeletonize", "demo/scan.ply", "--traits", "-o", "traits")
        self.runs("prunus", "convert", "tree/skeleton.json", "tree.mcap")
        self.has("traits/traits.parquet", 1)
        self.has("tree.mcap", 1)

    def has(self, name: str, least_bytes: int) -> None:
        """A file is there, and not too small."""
        path = self.work / name
        if not path.exists() or path.stat().st_size < least_bytes:
            raise WheelError(f"{name} is missing or shorter than {least_bytes} bytes")


def main() -> int:
    """Build, try everything, say what came of it; how many trials failed."""
    wheel = build()
    print(f"dist/{wheel.name}: built from its sdist, all files in it", flush=True)
    trials = [Trial(python, which, wheel) for python in PYTHONS for which in (LOWEST, NEWEST)]
    failed = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        running = {pool.submit(trial.run): trial for trial in trials}
        for done in as_completed(running):
            wrong = done.exception()
            print(f"{running[done].name}: {wrong}" if wrong else done.result(), flush=True)
            failed += wrong is not None
    return failed


if __name__ == "__main__":
    sys.exit(main())
