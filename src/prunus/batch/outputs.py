"""The folder of a tree: everything that a user wants of it, written together or not at all."""

from __future__ import annotations

from pathlib import Path

from prunus import __version__
from prunus.cuts import plan_cuts
from prunus.errors import PrunusError
from prunus.files.safely import write_bytes, written_together
from prunus.files.work_folder import PARAMS, PLAN, REFINED, REPORT, SKELETON
from prunus.frames.scan import Scan
from prunus.io.skeletons.export import write_ply
from prunus.io.skeletons.named import named_branches
from prunus.io.skeletons.plans import read_plan
from prunus.io.skeletons.skeleton_file import (
    nullable,
    read_skeleton,
    sha256_of,
    write_skeleton,
)
from prunus.io.skeletons.swc import write_swc
from prunus.io.skeletons.trust import trust_record
from prunus.io.tables import csv_bytes, parquet_bytes, without_nan
from prunus.names import as_text
from prunus.report import report_page
from prunus.result import Result
from prunus.traits.definitions import BRANCH_TRAITS, TREE_TRAITS
from prunus.traits.traits import branch_traits, tree_traits

SOMETIMES = (
    REPORT,
    "traits.csv",
    "traits.parquet",
    "tree_traits.csv",
    "tree_traits.parquet",
)
"""What only some runs write: that of an older run goes, or it would be taken for the new tree's."""


def write_all(
    folder: Path, result: Result, scan: Scan, report: bool = True, traits: bool = False
) -> list[str]:
    """The folder of a tree, skeleton.json last: where it is, all is. Notes on what is missing."""
    if folder.exists() and not folder.is_dir():
        raise PrunusError(f"{folder}: is a file; expected a folder to write to")
    older = [*SOMETIMES, *plan_of_older(folder, result)]
    with written_together(folder, SKELETON, older) as together:
        write_outputs(together, result, scan, report)
        return write_traits(together, result, scan.file.name) if traits else []


def plan_of_older(folder: Path, result: Result) -> list[str]:
    """plan.json, where it is of the skeleton that stands in the folder, and the new is another."""
    try:
        planned = read_plan(folder / PLAN).skeleton_sha256
        replaced = planned == sha256_of(read_skeleton(folder / SKELETON))
    except PrunusError:  # there is no plan, or none of a skeleton of ours
        return []
    return [PLAN] if replaced and planned != sha256_of(result.skeleton) else []


def write_outputs(folder: Path, result: Result, scan: Scan, report: bool) -> None:
    """skeleton.json, .swc and .ply, refined.json, params.toml and, where wanted, report.html."""
    if report:
        plan = plan_cuts(result.refined, result.scan.xyz)
        page = report_page(result, scan.file.name, [*scan.notes, *result.notes], plan)
        write_bytes(folder / REPORT, as_text(page).encode())
    write_swc(folder / "skeleton.swc", result.skeleton)
    write_ply(folder / "skeleton.ply", result.skeleton)
    write_bytes(folder / PARAMS, result.params.to_toml().encode())
    evidence = {
        "score": result.score,
        "input": scan.record,
        "read": {"frame": scan.asked[0], "unit": scan.asked[1]},
        "params": result.params.model_dump(),
        "seed": result.seed,
        "version_of_prunus": __version__,
    }
    fine = result.refined.skeleton.moved(result.graph.superpoints.cloud.to_input)
    trust = trust_record(result.in_house, result.trust)
    write_skeleton(
        folder / SKELETON, result.skeleton, trust=trust, review=result.review, **evidence
    )
    names = named_branches(fine, result.refined.names, result.refined.likely)
    write_skeleton(
        folder / REFINED,
        fine,
        branches=names,
        radius_error=nullable(result.refined.radius_error),
        seen=result.refined.seen.tolist(),
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
