"""What is corrected: a cloud, or a skeleton together with the cloud it came from."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from prunus.errors import PrunusError, naming
from prunus.frames.scan import Scan, open_scan
from prunus.io.original import original_of
from prunus.io.skeletons.skeleton_file import read_record
from prunus.model import Skeleton
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.result import Result
from prunus.session.journal import Head

Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Settings:
    """How the chain is run on an input, see `open_scan` and `skeletonize`, and where scans lie."""

    frame: str = "auto"
    unit: str | None = None
    params: Parameters = field(default_factory=Parameters)
    seed: int = 0
    scans: Path | None = field(default=None, compare=False)


@dataclass(frozen=True, eq=False, kw_only=True)
class Source:
    """A cloud file, how it is run, the base given to the chain, and the skeleton it should give."""

    path: Path
    settings: Settings
    base: Point | None = None
    expected: Skeleton | None = None


Kept = Callable[[Scan, Settings], tuple[Scan, Result] | None]
"""Finds what the machine made of a scan before, and the scan as it was turned then."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Machine:
    """What the chain made of an input, from which base, and what a person should know of it."""

    scan: Scan
    result: Result
    settings: Settings
    base: Point | None
    notes: list[str]


def source_from(path: Path, settings: Settings) -> Source:
    """What a path names: a cloud, or by a `skeleton.json` the cloud from which it came.

    A skeleton brings its own parameters and seed; its cloud is looked for as in `original_of`, with
    the same errors.
    """
    if path.suffix.lower() != ".json":
        return Source(path=path, settings=settings)
    skeleton, record = read_record(path)
    if record.input is None:
        raise PrunusError(f"{path}: does not say of which cloud it is; open the cloud instead")
    params = settings.params
    if record.params is not None:
        params = Parameters.of_record(record.params, f"{path}: params")
    seed = settings.seed if record.seed is None else record.seed
    own = replace(settings, params=params, seed=seed)
    with naming(path):
        cloud = original_of(record.input, path.parent, settings.scans)
    return Source(path=cloud, settings=own, expected=skeleton)


def unseen(scan: Scan) -> None:
    """Nobody wants to see the scan before the chain has run."""


def unkept(scan: Scan, settings: Settings) -> tuple[Scan, Result] | None:
    """Nothing was kept of what the machine made of a scan."""


def run(
    source: Source,
    head: Head | None,
    seen: Callable[[Scan], None] = unseen,
    kept: Kept = unkept,
) -> Machine:
    """Run the chain on a source, as the journal on it says where there is one.

    It is not run where what it gave when the journal was begun was kept.
    """
    settings, base, expected, notes = source.settings, source.base, source.expected, list[str]()
    if head is not None:
        settings = Settings(
            frame=head.frame,
            unit=head.unit,
            params=Parameters.of_record(head.params, "journal"),
            seed=head.seed,
        )
        base, expected = head.base, None
        if settings != source.settings:
            notes.append("frame, unit, parameters and seed are those of its journal")
    scan = open_scan(source.path, settings.frame, settings.unit)
    if head is not None and scan.file.sha256 != head.input.sha256:
        raise PrunusError(
            f"{source.path}: is another file than its journal was made on "
            f"({head.input.file}, sha256 {head.input.sha256[:12]}...)"
        )
    held = None if head is None else kept(scan, settings)
    scan = scan if held is None else held[0]
    seen(scan)
    result = _chain(source.path, scan, settings, base) if held is None else held[1]
    if expected is not None and not _same(result.skeleton, expected):
        base = (*expected.xyz[0].tolist(),)
        again = _chain(source.path, scan, settings, base)
        if _same(again.skeleton, expected):
            result = again
        else:
            base = None
            notes.append(
                "the chain gives another skeleton than the file has (by another version, scorer "
                "or frame?): it is the one shown"
            )
    return Machine(
        scan=scan,
        result=result,
        settings=settings,
        base=base,
        notes=[*scan.notes, *result.notes, *notes],
    )


def _chain(path: Path, scan: Scan, settings: Settings, base: Point | None) -> Result:
    with naming(path):
        return skeletonize(scan.cloud, base, settings.params, settings.seed)


def _same(one: Skeleton, other: Skeleton) -> bool:
    return (
        np.array_equal(one.parent, other.parent)
        and np.array_equal(one.label, other.label)
        and np.allclose(one.xyz, other.xyz, rtol=0, atol=CLOSE)
    )


CLOSE = 1e-4
"""Skeletons are the same when their nodes are so near, metres."""


def superpoints_digest(result: Result) -> str:
    """A digest of the nodes that acts name by number, and of what joins them."""
    cloud = result.graph.superpoints.cloud
    return _digest(_places(cloud.to_input.apply(result.graph.xyz)), result.graph.edges.tobytes())


def skeleton_digest(skeleton: Skeleton, *more: bytes) -> str:
    """A digest of a skeleton in the frame of its file."""
    columns = (skeleton.parent.tobytes(), skeleton.label.tobytes())
    return _digest(_places(skeleton.xyz), *columns, *more)


def _places(xyz: np.ndarray) -> bytes:
    return (np.round(xyz / CLOSE).astype(np.int64)).tobytes()


def _digest(*parts: bytes) -> str:
    whole = hashlib.sha256()
    for part in parts:
        whole.update(len(part).to_bytes(8, "little") + part)
    return whole.hexdigest()[:16]
