"""One file after another: read, skeletonize, write everything a user wants beside each other."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prunus import __version__
from prunus.cuts import plan_cuts
from prunus.errors import PrunusError, describe
from prunus.files.safely import write_bytes, written_together
from prunus.frames.scan import Scan, open_scan
from prunus.io.inputs import clouds_in, is_one, names_of
from prunus.io.records import EdgesByLabel, TreeRecord
from prunus.io.skeletons.export import write_ply
from prunus.io.skeletons.named import named_branches
from prunus.io.skeletons.plans import read_plan
from prunus.io.skeletons.skeleton_file import read_skeleton, sha256_of, write_skeleton
from prunus.io.skeletons.swc import write_swc
from prunus.io.skeletons.trust import trust_record
from prunus.io.tables import csv_bytes, parquet_bytes, without_nan
from prunus.model import Label
from prunus.model.branches import branches
from prunus.names import as_text, folder_name, in_line
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.processes.workers import side_by_side
from prunus.report import report_page
from prunus.result import Result, Seconds, timed
from prunus.traits.definitions import BRANCH_TRAITS, TREE_TRAITS
from prunus.traits.traits import branch_traits, tree_traits

if TYPE_CHECKING:
    from prunus.paper.confidence import EdgeScorer

Record = dict[str, Any]
"""What `--json` prints of one tree: a `TreeRecord`."""


@dataclass(frozen=True)
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
        notes = write_all(task.folder, result, scan, options)
    return _record(task, result, scan, seconds, notes)


SOMETIMES = (
    "report.html",
    "traits.csv",
    "traits.parquet",
    "tree_traits.csv",
    "tree_traits.parquet",
)
"""What only some runs write: that of an older run goes, or it would be taken for the new tree's."""
PLAN = "plan.json"


def write_all(folder: Path, result: Result, scan: Scan, options: Options) -> list[str]:
    """The folder of a tree, skeleton.json last: where it is, all is. Notes on what is missing."""
    if folder.exists() and not folder.is_dir():
        raise PrunusError(f"{folder}: is a file; expected a folder to write to")
    older = [*SOMETIMES, *plan_of_older(folder, result)]
    with written_together(folder, "skeleton.json", older) as together:
        write_outputs(together, result, scan, options.report)
        return write_traits(together, result, scan.file.name) if options.traits else []


def plan_of_older(folder: Path, result: Result) -> list[str]:
    """plan.json, where it is of the skeleton that stands in the folder, and the new is another."""
    try:
        planned = read_plan(folder / PLAN).skeleton_sha256
        replaced = planned == sha256_of(read_skeleton(folder / "skeleton.json"))
    except PrunusError:  # there is no plan, or none of a skeleton of ours
        return []
    return [PLAN] if replaced and planned != sha256_of(result.skeleton) else []


def write_outputs(folder: Path, result: Result, scan: Scan, report: bool) -> None:
    """skeleton.json, .swc and .ply, refined.json, params.toml and, where wanted, report.html."""
    if report:
        plan = plan_cuts(result.refined, result.scan.xyz)
        page = report_page(result, scan.file.name, [*scan.notes, *result.notes], plan)
        write_bytes(folder / "report.html", as_text(page).encode())
    write_swc(folder / "skeleton.swc", result.skeleton)
    write_ply(folder / "skeleton.ply", result.skeleton)
    write_bytes(folder / "params.toml", result.params.to_toml().encode())
    evidence = {
        "score": result.score,
        "input": scan.record,
        "params": result.params.model_dump(),
        "seed": result.seed,
        "version_of_prunus": __version__,
    }
    fine = result.refined.skeleton.moved(result.graph.superpoints.cloud.to_input)
    trust = trust_record(result.in_house, result.trust)
    write_skeleton(
        folder / "skeleton.json", result.skeleton, trust=trust, review=result.review, **evidence
    )
    names = named_branches(fine, result.refined.names, result.refined.likely)
    write_skeleton(
        folder / "refined.json",
        fine,
        branches=names,
        refines=sha256_of(result.skeleton),
        **evidence,
    )


def write_traits(folder: Path, result: Result, name: str) -> list[str]:
    """traits.csv, a row a branch, and tree_traits.csv, one row; the same as Parquet.

    Without pyarrow there is no Parquet; the lines returned say so.
    """
    tree = result.refined
    rows = branch_traits(tree, result.trust)
    tables = {
        "traits": ([{"tree": name, **row} for row in rows], BRANCH_TRAITS),
        "tree_traits": ([{"tree": name, **tree_traits(tree, result.trust)}], TREE_TRAITS),
    }
    notes = []
    for stem, (table, defined) in tables.items():
        records = [without_nan(row) for row in table]
        columns = {"tree": str, **{trait: defined[trait].kind for trait in defined}}
        write_bytes(folder / f"{stem}.csv", csv_bytes(records, list(columns)))
        try:
            write_bytes(folder / f"{stem}.parquet", parquet_bytes(records, columns))
        except PrunusError as error:
            notes.append(f"{stem}.parquet was not written: {error}")
    return notes


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
        skeleton=as_text(task.folder / "skeleton.json"),
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
