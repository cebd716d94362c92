"""One file after another: read, skeletonize, write, and a record of each."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prunus.batch.outputs import write_all
from prunus.errors import PrunusError, describe
from prunus.files.work_folder import SKELETON
from prunus.frames.scan import Scan, open_scan
from prunus.io.inputs import clouds_in, is_one, names_of
from prunus.io.records import EdgesByLabel, TreeRecord
from prunus.model import Label
from prunus.model.branches import branches
from prunus.names import as_text, folder_name, in_line
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.processes.workers import side_by_side
from prunus.result import Result, Seconds, timed

if TYPE_CHECKING:
    from prunus.paper.confidence import EdgeScorer

Record = dict[str, Any]
"""What `--json` prints of one tree: a `TreeRecord`."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """How every file of a batch is treated; `scorer` is for the paper's method alone."""

    base: tuple[float, float, float] | None = None
    frame: str = "auto"
    unit: str | None = None
    params: Parameters = field(default_factory=Parameters)
    seed: int = 0
    scorer: EdgeScorer | None = None
    report: bool = True
    traits: bool = False


@dataclass(frozen=True)
class Task:
    """One input and the folder of its outputs."""

    path: Path
    folder: Path


def plan(inputs: list[Path], output: Path | None) -> tuple[list[Task], list[Record]]:
    """The tasks of a batch, folders searched for clouds; inputs that cannot be one as failures.

    One input is written to `output`, several to a folder of their own name below it
    (see `names_of`).
    """
    files: list[Path] = []
    failed = []
    for path in inputs:
        try:
            inside = clouds_in(path) if path.is_dir() else [path]
        except OSError as error:
            failed.append(failure(path, f"{path}: cannot be read ({error.strerror})"))
            continue
        if not inside:
            failed.append(failure(path, f"{path}: no point cloud in this folder"))
        files += inside
    root = output or Path("prunus-out")
    if output is not None and len(files) == len(inputs) == 1 and is_one(inputs[0]):
        return [Task(files[0], output)], failed
    tasks: dict[Path, Task] = {}
    for path, name in zip(files, names_of(files), strict=True):
        folder = root / folder_name(name)
        if folder in tasks:
            other = tasks[folder].path
            text = f"{path}: has the same name as {other}; both would be written to {folder}"
            failed.append(failure(path, text))
        else:
            tasks[folder] = Task(path, folder)
    return list(tasks.values()), failed


def run(tasks: list[Task], options: Options, jobs: int) -> Iterator[Record]:
    """A record of each task as it is done; a bad file gives a record that says why.

    One tree alone is done in this process, several in others, so that one of them may crash. Where
    kernels have to be compiled, the first run of all works on one tree first, so that that is done
    only once.
    """
    if len(tasks) == 1:
        yield attempt(tasks[0], options)
        return
    alone = 1 if _compiles(options.params) else 0
    for some, at_once in ((tasks[:alone], 1), (tasks[alone:], jobs)):
        with closing(side_by_side(partial(attempt, options=options), some, at_once)) as all_done:
            for done in all_done:
                yield done.made or _gave(some[done.number], done.error)


def _compiles(params: Parameters) -> bool:
    """Whether the next run compiles kernels."""
    if params.method == "default":
        return False
    from prunus.geometry.compiled import is_compiled

    return not is_compiled(params.method)


def _mark_compiled(params: Parameters) -> None:
    """Remember what a run has compiled."""
    if params.method != "default":
        from prunus.geometry.compiled import mark_compiled

        mark_compiled(params.method)


def attempt(task: Task, options: Options) -> Record:
    """Do one task; what goes wrong with it, foreseen or not, becomes a record of failure."""
    try:
        return do(task, options)
    except Exception as error:  # a fault of ours costs one tree, and not the batch
        return _gave(task, error)


def _gave(task: Task, error: Exception | None) -> Record:
    """The record of a task of which an exception came."""
    text = describe(error or PrunusError("nothing came of it"))
    return failure(task.path, text if in_line(task.path) in text else f"{task.path}: {text}")


def do(task: Task, options: Options) -> Record:
    """Read the file, skeletonize it, write all outputs, and return what `--json` prints."""
    seconds: Seconds = {}
    with timed(seconds, "read"):
        scan = open_scan(task.path, options.frame, options.unit)
    given = options.base, options.params, options.seed, options.scorer
    result = skeletonize(scan.cloud, *given)
    seconds |= result.seconds
    with timed(seconds, "refine"):
        _ = result.refined
    with timed(seconds, "trust"):
        _ = result.review
    _mark_compiled(options.params)
    with timed(seconds, "write"):
        notes = write_all(task.folder, result, scan, options.report, options.traits)
    return _record(task, result, scan, seconds, notes)


def _record(
    task: Task,
    result: Result,
    scan: Scan,
    seconds: Seconds,
    notes: list[str],
) -> Record:
    skeleton, graph = result.skeleton, result.graph
    columns: list[dict[str, float]] = []
    for kind in (0, 1):
        spent = {stage: round(both[kind], 4) for stage, both in seconds.items()}
        columns.append({**spent, "total": round(sum(both[kind] for both in seconds.values()), 4)})
    return TreeRecord(
        file=as_text(task.path),
        ok=True,
        error=None,
        skeleton=as_text(task.folder / SKELETON),
        score=result.score,
        points=len(scan.cloud),
        superpoints=len(graph.xyz),
        candidates=len(graph.edges),
        edges=len(skeleton.edges),
        tips=len(graph.tips),
        labels=EdgesByLabel(**{one.word: int(skeleton.edges_with(one).sum()) for one in Label}),
        leaders=len(branches(skeleton, Label.LEADER)),
        side_branches=len(branches(skeleton, Label.SIDE_BRANCH)),
        cpu_s=columns[0],
        wall_s=columns[1],
        trust=None if result.trust is None else round(result.trust.tree, 4),
        review=result.review,
        warnings=[*map(as_text, [*scan.notes, *result.notes, *result.warnings, *notes])],
    ).model_dump()


def failure(path: Path, text: str) -> Record:
    """The record of a file that could not be done."""
    return TreeRecord(file=as_text(path), ok=False, error=in_line(text)).model_dump()
