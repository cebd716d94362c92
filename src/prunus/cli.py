"""The command line: one short function a command; heavy imports inside the command."""

from __future__ import annotations

import os
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from prunus import __version__
from prunus.errors import PrunusError

if TYPE_CHECKING:
    from prunus.params import Parameters

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="""From a 3D point cloud of a dormant fruit tree to a labelled skeleton.

Try it: `prunus demo`

One tree, base picked by hand: `prunus skeletonize tree.ply --base 1.40 0.90 1.42 -o out`

A folder of trees, two at a time: `prunus skeletonize scans/ -o out --jobs 2`
""",
)


class Frame(StrEnum):
    """Named input frames (docs/frames.md)."""

    AUTO = "auto"
    Z_UP = "z-up"
    Z_UP_X_ROW = "z-up-x-row"
    OPTICAL = "optical"
    CAMERA_LINK = "camera-link"
    Y_UP = "y-up"
    Z_DOWN = "z-down"
    X_UP = "x-up"
    X_DOWN = "x-down"


class Unit(StrEnum):
    """Units of the input file."""

    M = "m"
    CM = "cm"
    MM = "mm"


class ScanKind(StrEnum):
    """Settings of a simulated scan."""

    FIELD = "field"
    CLEAN = "clean"


class Scorer(StrEnum):
    """Who gives the edge confidence."""

    CNN = "cnn"
    HANDMADE = "handmade"


class Network(StrEnum):
    """What can be learned."""

    EDGES = "edges"
    ISOLATION = "isolation"


class EdgeNet(StrEnum):
    """Edge networks."""

    OURS = "ours"
    PAPER = "paper"


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"prunus {__version__}")
        raise typer.Exit


@app.callback()
def _prunus(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Say the version.")
    ] = False,
) -> None:
    """Hold the options before any command."""


@app.command()
def skeletonize(
    clouds: Annotated[list[Path], typer.Argument(help="Point clouds, bags, or folders of them.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder to write to. [default: prunus-out/NAME]"),
    ] = None,
    base: Annotated[
        tuple[float, float, float] | None,
        typer.Option(help="A point where the trunk meets the ground, in the frame of the file."),
    ] = None,
    frame: Annotated[
        Frame, typer.Option(help="Frame of the file; auto goes by the evidence in the cloud.")
    ] = Frame.AUTO,
    unit: Annotated[
        Unit | None, typer.Option(help="Unit of the file. [default: m, checked]")
    ] = None,
    points: Annotated[
        str | None, typer.Option(help="Points drawn at random, or 'all'. [default: 50000]")
    ] = None,
    params: Annotated[
        Path | None,
        typer.Option(help="Parameters as TOML, as every run writes it; 'paper': as in the paper."),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of all that is random.")] = 0,
    scorer: Annotated[Scorer, typer.Option(help="Who gives the edge confidence.")] = Scorer.CNN,
    weights: Annotated[
        Path | None, typer.Option(help="Your own network, made by `prunus train`.")
    ] = None,
    no_isolate: Annotated[
        bool, typer.Option("--no-isolate", help="The cloud is the tree alone: take nothing out.")
    ] = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no report.html.")] = False,
    traits: Annotated[
        bool, typer.Option("--traits", help="Write traits of branches and tree, CSV and Parquet.")
    ] = False,
    json: Annotated[
        bool, typer.Option("--json", help="One line of JSON a tree on standard output.")
    ] = False,
    jobs: Annotated[int, typer.Option(min=1, help="Trees worked on at the same time.")] = 1,
) -> None:
    """Turn clouds (PLY, PCD, XYZ, TXT, CSV, LAS, LAZ, NPY, NPZ, ROS bags) into labelled skeletons.

    Writes skeleton.json, skeleton.swc, skeleton.ply, refined.json, report.html and params.toml for
    each tree.

    In a camera's frame: `prunus skeletonize tree.ply --frame optical --base 1.4 0.9 1.4`

    A topic of a ROS 1 or 2 bag: `prunus skeletonize row.mcap#/camera/points`

    Many, for a script: `prunus skeletonize scans/*.ply -o out --jobs 4 --json > trees.jsonl`
    """
    from prunus.batch import Options, plan

    try:
        options = Options(
            base, frame.value, unit and unit.value, _parameters(params, points, no_isolate), seed,
            scorer.value, weights, not no_report, traits,
        )  # fmt: skip
    except PrunusError as error:
        _stop(error)
    tasks, failed = plan(clouds, output)
    _report(tasks, failed, options, json, jobs)


@app.command()
def isolate(
    raw: Annotated[Path, typer.Argument(help="A raw scan: ground, posts, wires, neighbours.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The tree's own points (PLY, XYZ, NPZ).")
    ] = None,
    at: Annotated[
        tuple[float, float, float] | None,
        typer.Option(help="Where the tree stands, in the frame of the file. [default: the middle]"),
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="Only list the trees in view.")] = False,
    every: Annotated[bool, typer.Option("--all", help="Write each tree in view.")] = False,
    classes: Annotated[
        bool, typer.Option("--classes", help="Write all points, with what each is (PLY).")
    ] = False,
    frame: Annotated[
        Frame, typer.Option(help="Frame of the file; auto goes by the evidence in the cloud.")
    ] = Frame.AUTO,
    unit: Annotated[
        Unit | None, typer.Option(help="Unit of the file. [default: m, checked]")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of all that is random.")] = 0,
) -> None:
    """Take one tree out of a raw scan; the scan itself stays as it is.

    What is there: `prunus isolate raw.ply --list`

    One of them: `prunus isolate raw.ply -o tree.ply --at 0.35 1.10 1.45`

    To see what each point was taken for: `prunus isolate raw.ply -o classes.ply --classes`
    """
    from prunus.isolation import Opened, list_trees, write_all, write_tree

    try:
        if output is None and not list_:
            raise PrunusError("nowhere to write to: say -o TREE.ply, or --list")
        opened = Opened.of(raw, frame.value, unit and unit.value, seed)
        if output is None or list_:
            lines = list_trees(opened)
        elif every:
            lines = write_all(opened, output, classes)
        else:
            lines = write_tree(opened, output, at, classes)
    except PrunusError as error:
        _stop(error)
    for line in lines:
        typer.echo(line)


@app.command()
def demo(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder to write to.")] = Path(
        "prunus-out/demo"
    ),
    seed: Annotated[int, typer.Option(min=0, help="Another seed, another tree.")] = 0,
) -> None:
    """Grow a tree, scan it, skeletonize the scan, compare with the truth, write the report."""
    from prunus.batch import Options, Task
    from prunus.demo import compare, simulated_scan

    try:
        truth = simulated_scan(output, seed)
    except PrunusError as error:
        _stop(error)
    base = tuple(truth.xyz[0].tolist())
    _report([Task(output / "scan.ply", output)], [], Options(base, "z-up", seed=seed), False, 1)
    for line in [*compare(output, truth), f"  now open {output / 'report.html'}"]:
        typer.echo(line)


@app.command()
def simulate(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder to write to.")],
    trees: Annotated[int, typer.Option("-n", "--trees", min=1, help="How many trees.")] = 30,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first; the next has the next.")] = 0,
    scan: Annotated[ScanKind, typer.Option(help="field: all faults; clean: hardly any.")] = (
        ScanKind.FIELD
    ),
    views: Annotated[bool, typer.Option("--views", help="Write the depth images too.")] = False,
    jobs: Annotated[int, typer.Option(min=1, help="Trees at the same time.")] = os.cpu_count() or 1,
) -> None:
    """Grow an orchard and scan it: clouds with the truth of every point, and true skeletons.

    Thirty trees to learn from or to judge by: `prunus simulate -n 30 -o orchard`
    """
    from prunus.progress import progress_bar
    from prunus.simulate.orchard import simulate_orchard

    seeds = range(seed, seed + trees)
    try:
        with progress_bar() as bar:
            work = bar.add_task("trees", total=trees)
            for _ in simulate_orchard(output, seeds, scan.value, views, min(jobs, trees)):
                bar.advance(work)
    except PrunusError as error:
        _stop(error)
    typer.echo(f"{trees} trees written to {output}")


@app.command()
def train(
    folders: Annotated[
        list[Path], typer.Argument(help="Simulated scans, or the studio's folders with labels.")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Weights to write (.onnx).")],
    network: Annotated[
        Network, typer.Option(help="edges: their confidence; isolation: one tree out of a scan.")
    ] = Network.EDGES,
    edge_net: Annotated[
        EdgeNet, typer.Option(help="paper: Appendix A; ours: edges in context.")
    ] = EdgeNet.OURS,
    start: Annotated[
        str | None,
        typer.Option(
            "--from", help="Go on from: ours, paper, a file, scratch. [default: ours with labels]"
        ),
    ] = None,
    scans: Annotated[
        Path | None, typer.Option(help="Where the labelled scans lie. [default: looked for]")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of all that is random.")] = 0,
    epochs: Annotated[int | None, typer.Option(min=1, help="[default: as the recipe]")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Scans at the same time.")] = os.cpu_count() or 1,
) -> None:
    """Learn the edge confidence (or isolation) from simulated scans; prints the paper's tables.

    `prunus train orchard -o mine.onnx`, then `prunus skeletonize tree.ply --weights mine.onnx`

    From edges labelled in the studio, going on from our network: `prunus train prunus-studio -o
    mine.onnx`
    """
    from prunus.learn.school import Course, isolation_school, lines_of, school
    from prunus.progress import bar_of, progress_bar

    try:
        with progress_bar() as bar:
            course = Course(edge_net.value, start, seed, epochs, scans)
            teach = isolation_school if network == Network.ISOLATION else school
            report = teach(folders, output, course, jobs, bar_of(bar))
    except PrunusError as error:
        _stop(error)
    if network == Network.ISOLATION:
        kept, removed = report["test"]
        typer.echo(f"test trees: {kept:.1%} of the points kept, {removed:.1%} of all others out")
        return
    for line in lines_of(report):
        typer.echo(line)


@app.command()
def evaluate(
    skeleton: Annotated[Path, typer.Argument(help="A skeleton, or a folder of them.")],
    gold: Annotated[Path, typer.Argument(help="Its gold standard, or a folder of them.")],
    json: Annotated[bool, typer.Option("--json", help="One line of JSON a pair.")] = False,
    csv: Annotated[Path | None, typer.Option(help="Write a table, one row a pair.")] = None,
) -> None:
    """Measure skeletons against gold standards: what was found, and what of it is right.

    One pair: `prunus evaluate out/skeleton.json gold.json`

    Two folders: `prunus evaluate out orchard --csv measures.csv`

    Reads skeletons of other tools too (PLY edges, SWC, OBJ lines, GraphML), for the geometry.
    """
    from json import dumps

    from prunus.io.safely import write_bytes
    from prunus.io.tables import csv_bytes, without_nan
    from prunus.judge import compare, pairs_in, spread_lines

    try:
        records = [without_nan(compare(*pair)) for pair in pairs_in(skeleton, gold)]
        if csv is not None:
            write_bytes(csv, csv_bytes(records))
    except PrunusError as error:
        _stop(error)
    lines = [dumps(record) for record in records] if json else spread_lines(records)
    for line in lines:
        typer.echo(line)


@app.command()
def experiment(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder to write to.")],
    trees: Annotated[int, typer.Option(min=1, help="How many trees.")] = 29,
    draws: Annotated[int, typer.Option(min=1, help="Draws of 50 000 points a tree.")] = 3,
    scan: Annotated[ScanKind, typer.Option(help="field: all faults; clean: hardly any.")] = (
        ScanKind.FIELD
    ),
    seed: Annotated[int, typer.Option(min=0, help="Another seed, other trees.")] = 0,
    gold: Annotated[
        Path | None,
        typer.Option(help="Your own trees in place of simulated ones: the studio's work folder."),
    ] = None,
    scans: Annotated[
        Path | None, typer.Option(help="Where your own scans lie. [default: looked for]")
    ] = None,
    ablation: Annotated[
        bool, typer.Option("--ablation", help="Also what each part brings, one at a time.")
    ] = False,
    jobs: Annotated[int, typer.Option(min=1, help="Trees at the same time.")] = os.cpu_count() or 1,
) -> None:
    """Run the paper's result section on simulated trees or your own: tables, figures, a page.

    A quick look: `prunus experiment -o out --trees 6 --draws 1`

    On your own trees, corrected in the studio: `prunus experiment --gold prunus-studio -o out`

    Stopped half way, the same command goes on where it was.
    """
    from prunus.experiment.results import Orchard, experiment, lines_of
    from prunus.progress import bar_of, progress_bar

    try:
        if gold is None:
            orchard = Orchard.simulated(trees, scan.value, seed)
        else:
            orchard = Orchard.corrected(gold, scans)
        with progress_bar() as bar:
            results = experiment(output, orchard, draws, ablation, jobs, bar_of(bar))
    except PrunusError as error:
        _stop(error)
    for line in [*lines_of(results), "", f"written to {output / 'index.html'}"]:
        typer.echo(line)


@app.command()
def studio(
    path: Annotated[Path, typer.Argument(help="A scan, a skeleton.json, or a folder of them.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder in which the work is kept.")
    ] = Path("prunus-studio"),
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="The next free one is taken; 0: any.")
    ] = 8080,
    host: Annotated[
        str, typer.Option(help="Address to listen on; other machines need the token then.")
    ] = "127.0.0.1",
    token: Annotated[
        str | None, typer.Option(help="Asked for on the page. [default: random, off this machine]")
    ] = None,
    no_open: Annotated[bool, typer.Option("--no-open", help="Open no browser.")] = False,
    frame: Annotated[
        Frame, typer.Option(help="Frame of the file; auto goes by the evidence in the cloud.")
    ] = Frame.AUTO,
    unit: Annotated[
        Unit | None, typer.Option(help="Unit of the file. [default: m, checked]")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of all that is random.")] = 0,
    params: Annotated[
        Path | None,
        typer.Option(help="Parameters as TOML, as every run writes it; 'paper': as in the paper."),
    ] = None,
) -> None:
    """Look at trees, clean, correct and label them, on a page in the browser.

    A folder of scans: `prunus studio scans/ -o work`

    On another machine: `ssh -t -L 8080:localhost:8080 there prunus studio scans/ --no-open`
    """
    from prunus.corrections import Settings
    from prunus.studio.start import open_studio

    try:
        settings = Settings(
            frame=frame.value, unit=unit and unit.value, seed=seed,
            params=_parameters(params, None, False),
        )  # fmt: skip
        open_studio(path, output, settings, host, port, token, not no_open, typer.echo)
    except PrunusError as error:
        _stop(error)


@app.command()
def fuse(
    rig: Annotated[Path, typer.Argument(help="Folder with rig.json, or with *_cloud.ply.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Cloud to write, as .ply.")],
    report: Annotated[
        Path | None, typer.Option(help="Write refined poses and residuals as JSON.")
    ] = None,
) -> None:
    """Fuse depth images or partial clouds of a rig to one cloud; refines their poses together.

    `prunus simulate -n 1 -o rig --views`, then `prunus fuse rig/tree_000000 -o raw.ply`

    docs/fuse.md describes rig.json. A view that does not fit the others is left out, and said.
    """
    from prunus.fusing import fuse_folder, lines_of

    try:
        fused = fuse_folder(rig, output, report)
    except PrunusError as error:
        _stop(error)
    for line in [*lines_of(fused), f"{len(fused.xyz)} points written to {output}"]:
        typer.echo(line)


@app.command()
def cuts(
    source: Annotated[Path, typer.Argument(help="A skeleton (.json, .swc) or a point cloud.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Plan to write, as .json.")
    ] = None,
    rules: Annotated[
        Path | None, typer.Option(help="Rules as TOML, where they differ from ours.")
    ] = None,
    base: Annotated[
        tuple[float, float, float] | None,
        typer.Option(help="Of a cloud: where the trunk meets the ground, in the file's frame."),
    ] = None,
    frame: Annotated[
        Frame, typer.Option(help="Frame of the file; auto goes by the evidence in the cloud.")
    ] = Frame.AUTO,
    unit: Annotated[
        Unit | None, typer.Option(help="Unit of the cloud. [default: m, checked]")
    ] = None,
    scans: Annotated[
        Path | None, typer.Option(help="Where the scan of a skeleton lies. [default: looked for]")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="The plan as one line of JSON.")] = False,
) -> None:
    """Plan pruning cuts by rules: where the blade goes, how a tool comes to it, and what is unsure.

    From a scan: `prunus cuts tree.ply -o plan.json`

    From a skeleton, corrected or not, by rules of your own: `prunus cuts out/skeleton.json --rules
    mine.toml`

    docs/cuts.md has the rules. A cut with a `look:` is for a person to look at before it is made.
    """
    from prunus.cutting import Source, cut_file, lines_of
    from prunus.io.plans import write_plan
    from prunus.measure.cuts import CutRules, shipped_rules

    try:
        wanted = shipped_rules() if rules is None else CutRules.from_toml(rules)
        plan = cut_file(Source(source, base, frame.value, unit and unit.value, scans), wanted)
        if output is not None:
            write_plan(output, plan)
    except PrunusError as error:
        _stop(error)
    for line in [plan.model_dump_json()] if json else lines_of(plan):
        typer.echo(line)


@app.command()
def convert(
    source: Annotated[Path, typer.Argument(help="A skeleton (.json, .swc) or a point cloud.")],
    target: Annotated[Path, typer.Argument(help="What to write; the ending says which kind.")],
    unit: Annotated[Unit | None, typer.Option(help="Unit of a cloud. [default: m]")] = None,
    cloud: Annotated[
        Path | None, typer.Option(help="The cloud, to go into a bag (.mcap) with the tree.")
    ] = None,
    cuts: Annotated[
        Path | None, typer.Option(help="A plan (see `prunus cuts`), to go into the bag as poses.")
    ] = None,
) -> None:
    """Convert skeletons and clouds to what others read; says what a kind of file cannot hold.

    Skeletons: .json .swc .ply .graphml .glb .gltf .obj .mtg .cylinders.csv .treeqsm.csv
    .txt (raycloudtools) .mcap (ROS 2). Clouds: .ply .xyz .txt .csv .npy .npz.

    For Blender, thick as it is: `prunus convert out/refined.json tree.glb`

    For RViz or Foxglove: `prunus convert out/refined.json tree.mcap --cloud tree.ply --cuts
    plan.json`

    A cloud for another tool: `prunus convert tree.laz tree.xyz`
    """
    from prunus.convert import convert_file

    try:
        notes = convert_file(source, target, unit and unit.value, cloud, cuts)
    except PrunusError as error:
        _stop(error)
    for note in notes:
        typer.echo(f"{target}: {note}", err=True)


def _parameters(path: Path | None, points: str | None, no_isolate: bool) -> Parameters:
    from prunus.params import Parameters

    if path == Path("paper") and not path.exists():
        params = Parameters.paper()
    else:
        params = Parameters() if path is None else Parameters.from_toml(path)
    if no_isolate:
        params = params.changed("isolation", isolate="never")
    if points is None:
        return params
    if points not in ("all", "none") and not points.isdigit():
        raise PrunusError(f"--points: {points!r}; expected a number or 'all'")
    return params.changed("input", points=int(points) if points.isdigit() else points)


def _report(tasks: list[Any], failed: list[Any], options: Any, as_json: bool, jobs: int) -> None:
    """Run the tasks, say what came of each, and exit with 1 if any failed."""
    from prunus.batch import run
    from prunus.kernels.compiled import is_compiled
    from prunus.progress import Teller

    with Teller(len(tasks), as_json) as teller:
        if tasks and not is_compiled():
            teller.say("compiling the kernels (the first run only, about half a minute)")
        for record in failed:
            teller.tell(record)
        for record in run(tasks, options, jobs):
            teller.tell(record)
    if teller.failures:
        raise typer.Exit(1)


def _stop(error: PrunusError) -> NoReturn:
    typer.echo(f"prunus: {error}", err=True)
    raise typer.Exit(2)


def main() -> None:
    """Run the command line; a closed pipe and Ctrl-C end it quietly."""
    try:
        app()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)


if __name__ == "__main__":
    main()
