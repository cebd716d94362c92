"""The demonstration: a simulated scan through the whole chain."""

from __future__ import annotations

from pathlib import Path

from prunus.files.work_folder import SCAN, SKELETON, TRUTH
from prunus.io.clouds.cloud_file import write_cloud
from prunus.io.skeletons.skeleton_file import read_skeleton, write_skeleton
from prunus.lab.evaluate.curves import curve_measures
from prunus.lab.simulate import simulate_scan
from prunus.model import Label, Skeleton


def simulated_scan(folder: Path, seed: int) -> Skeleton:
    """Grow and scan a tree; writes its points in the scan and truth.json; returns the truth."""
    scan = simulate_scan(seed)
    cloud = scan.target_cloud()
    write_cloud(folder / SCAN, cloud.to_input.apply(cloud.xyz))
    write_skeleton(folder / TRUTH, scan.truth)
    return scan.truth


def compare(folder: Path, truth: Skeleton) -> list[str]:
    """Lines that say how much of each label was found and how much of what was found is right."""
    measures = curve_measures(read_skeleton(folder / SKELETON), truth)
    lines = ["  against the truth:  found  right"]
    for label in Label:
        recall, precision = (measures[f"{label.word}_{kind}"] for kind in ("recall", "precision"))
        name = label.word.replace("_", " ")
        lines.append(f"    {name:<17} {recall:5.0%}  {precision:5.0%}".replace("nan%", "   -"))
    return lines
