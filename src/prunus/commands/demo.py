"""`prunus demo`: a simulated tree through the whole chain."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from prunus.commands.options import OutputFolder, Seed
from prunus.commands.skeletonize import report_on
from prunus.files.work_folder import REPORT, SCAN

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def demo(
    ctx: typer.Context, output: OutputFolder = Path("prunus-out/demo"), seed: Seed = 0
) -> None:
    """Grow a tree, scan it, skeletonize the scan, compare with the truth.

    Another seed, another tree: `prunus demo --seed 7`
    """
    from prunus.batch.run import Options, Task
    from prunus.lab.demo import compare, simulated_scan

    waiting: Waiting = ctx.obj
    waiting.doing("growing and scanning a tree")
    truth = simulated_scan(output, seed)
    base = tuple(truth.xyz[0].tolist())
    options = Options(base=base, frame="z-up", seed=seed)
    report_on(waiting, [Task(output / SCAN, output)], [], options, False, 1)
    waiting.tell([*compare(output, truth), f"  now open {output / REPORT}"])
