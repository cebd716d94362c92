"""The command line: one short function a command; heavy imports inside the command."""

from __future__ import annotations

import os
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from prunus import __version__
from prunus.errors import OptionError, PrunusError, Status, blaming_the_command, describe
from prunus.processes.ending import end_on_signals

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting
    from prunus.paper.networks import NetworkScorer
    from prunus.params import Parameters


class Prunus(TyperGroup):
    """All commands: what is wrong is said in a line, and by the exit status."""

    def invoke(self, ctx: Any) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except PrunusError as error:
            ctx.obj.say(f"prunus: {error}")
            raise typer.Exit(Status.of(error)) from None


app = typer.Typer(
    cls=Prunus,
    no_args_is_help=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="""From a 3D point cloud of a dormant fruit tree to a labelled skeleton.

Try it: `prunus demo`

Your own scan: `prunus skeletonize tree.ply -o out`

A folder of scans, two at a time: `prunus skeletonize scans/ -o out --jobs 2`
""",
)
TREES, LEARNING, SHIPPED = "Trees", "Learning and judging", "What is shipped"


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
    FT = "ft"
    US_FT = "us-ft"
    IN = "in"


class OrchardKind(StrEnum):
    """Settings of a simulated orchard and its scans."""

    ORDINARY = "ordinary"
    HARD = "hard"
    CLEAN = "clean"
    FIELD = "field"


class ScanKind(StrEnum):
    """The same, and scans of the wide orchard."""

    ORDINARY = "ordinary"
    HARD = "hard"
    CLEAN = "clean"
    ANY = "any"
    FIELD = "field"


class Network(StrEnum):
    """What can be learned."""

    EDGES = "edges"
    FIELD = "field"


Place = tuple[float, float, float]
OutputFolder = Annotated[Path, typer.Option("-o", "--output", help="Folder to write to.")]
BasePoint = Annotated[
    Place | None,
    typer.Option(
        "--base", "--at", help="Where the trunk meets the ground: metres, in the frame of the file."
    ),
]
FrameOfFile = Annotated[
    Frame,
    typer.Option("--frame", help="Axes of the file (docs/frames.md); auto: by the evidence in it."),
]
UnitOfFile = Annotated[
    Unit | None,
    typer.Option("--unit", help="Unit of the file. [default: its header's, else m]"),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of all that is random.")]
Points = Annotated[
    str | None,
    typer.Option("--points", help="Points drawn at random, or 'all'. [default: 100000]"),
]
ParamsFile = Annotated[
    Path | None,
    typer.Option("--params", help="TOML as `prunus params` prints it; or 'paper'."),
]
Weights = Annotated[
    Path | None,
    typer.Option(
        "--weights",
        exists=True,
        dir_okay=False,
        help="Your own network of edges for the paper's method, by `prunus train`.",
    ),
]
NoIsolate = Annotated[
    bool, typer.Option("--no-isolate", help="The cloud is the tree alone: take nothing out.")
]
Scans = Annotated[
    Path | None,
    typer.Option(
        "--scans", exists=True, file_okay=False, help="Where scans lie. [default: looked for]"
    ),
]
Jobs = Annotated[int, typer.Option("--jobs", min=1, help="Trees at the same time.")]
SCANS = (
    "ordinary: the paper's own orchard; hard: every habit that breaks methods (once 'field'); "
    "clean: the same, hardly disturbed"
)
CORES = os.cpu_count() or 1


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"prunus {__version__}")
        raise typer.Exit


@app.callback()
def _prunus(
    ctx: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Say the version.")
    ] = False,
) -> None:
    """Have every command told of while it is waited for."""
    from prunus.commands.progress import Waiting

    ctx.obj = ctx.with_resource(Waiting())


@app.command(rich_help_panel=TREES)
def skeletonize(
    ctx: typer.Context,
    clouds: Annotated[list[Path], typer.Argument(help="Point clouds, bags, or folders of them.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder to write to. [default: prunus-out/NAME]"),
    ] = None,
    base: BasePoint = None,
    frame: FrameOfFile = Frame.AUTO,
    unit: UnitOfFile = None,
    points: Points = None,
    params: ParamsFile = None,
    seed: Seed = 0,
    weights: Weights = None,
    no_isolate: NoIsolate = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no report.html.")] = False,
    traits: Annotated[
        bool, typer.Option("--traits", help="Write traits of branches and tree, CSV and Parquet.")
    ] = False,
    json: Annotated[
        bool, typer.Option("--json", help="One line of JSON a tree on standard output.")
    ] = False,
    jobs: Jobs = 1,
) -> None:
    """Turn scans (clouds, ROS bags) into labelled skeletons.

    Reads PLY, PCD, XYZ, TXT, CSV, LAS, LAZ, NPY, NPZ. Writes skeleton.json, .swc and .ply,
    refined.json, report.html and params.toml for each tree.

    By hand: `prunus skeletonize tree.ply --base 1.40 0.90 1.42 -o out`

    A camera's frame: `prunus skeletonize tree.ply --frame optical`

    A topic of a bag: `prunus skeletonize row.mcap#/camera/points`

    For a script: `prunus skeletonize scans/ --jobs 4 --json > trees.jsonl`
    """
    from prunus.commands.skeletonize import Options, plan

    options = Options(
        base, frame.value, unit and unit.value, _parameters(params, points, no_isolate), seed,
        _network(weights), not no_report, traits,
    )  # fmt: skip
    _check_use(options.params, weights)
    tasks, failed = plan(clouds, output)
    _report(ctx.obj, tasks, failed, options, json, jobs)


@app.command(rich_help_panel=TREES)
def isolate(
    ctx: typer.Context,
    raw: Annotated[Path, typer.Argument(help="A raw scan: ground, posts, wires, neighbours.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The tree's own points (PLY, XYZ, NPZ).")
    ] = None,
    base: BasePoint = None,
    list_: Annotated[bool, typer.Option("--list", help="Only list the trees in view.")] = False,
    every: Annotated[bool, typer.Option("--all", help="Write each tree in view.")] = False,
    classes: Annotated[
        bool, typer.Option("--classes", help="Write all points, with what each is (PLY).")
    ] = False,
    frame: FrameOfFile = Frame.AUTO,
    unit: UnitOfFile = None,
    seed: Seed = 0,
) -> None:
    """Take one tree out of a raw scan; the scan itself stays as it is.

    What is there: `prunus isolate raw.ply --list`

    One of them: `prunus isolate raw.ply -o tree.ply --at 0.35 1.10 1.45`

    What each point was taken for: `prunus isolate raw.ply -o c.ply --classes`
    """
    waiting: Waiting = ctx.obj
    if output is None and not list_:
        raise OptionError("nowhere to write to: say -o TREE.ply, or --list")
    if base is not None and (every or list_):
        raise OptionError("--at: of one tree; expected neither --all nor --list beside it")
    from prunus.commands.isolate import Opened, check_output, list_trees, write_all, write_tree

    if output is not None:
        check_output(output, classes)
    waiting.doing(f"looking at {raw}")
    opened = Opened.of(raw, frame.value, unit and unit.value, seed, base)
    if output is None or list_:
        lines = list_trees(opened)
    elif every:
        lines = write_all(opened, output, classes)
    else:
        lines = write_tree(opened, output, classes)
    waiting.tell(lines)


@app.command(rich_help_panel=TREES)
def cuts(
    ctx: typer.Context,
    source: Annotated[Path, typer.Argument(help="A skeleton (.json, .swc) or a point cloud.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Plan to write, as .json.")
    ] = None,
    rules: Annotated[
        Path | None,
        typer.Option(
            exists=True, dir_okay=False, help="TOML; what it does not name is as `prunus rules`."
        ),
    ] = None,
    base: BasePoint = None,
    frame: FrameOfFile = Frame.AUTO,
    unit: UnitOfFile = None,
    points: Points = None,
    params: ParamsFile = None,
    seed: Seed = 0,
    weights: Weights = None,
    no_isolate: NoIsolate = False,
    scans: Scans = None,
    json: Annotated[bool, typer.Option("--json", help="The plan as one line of JSON.")] = False,
) -> None:
    """Plan pruning cuts by rules: where the blade goes, and what is unsure.

    From a scan: `prunus cuts tree.ply -o plan.json`

    From a skeleton: `prunus cuts out/skeleton.json --rules mine.toml`

    docs/cuts.md has the rules. A cut with a `look:` is for a person to look at before it is made.
    """
    from prunus.cuts import CutRules, shipped_rules
    from prunus.cuts.plan_file import Source, cut_file, lines_of
    from prunus.io.skeletons.plans import write_plan

    waiting: Waiting = ctx.obj
    wanted = Source(
        source, base, frame.value, unit and unit.value, scans,
        _parameters(params, points, no_isolate), seed, _network(weights),
    )  # fmt: skip
    _check_use(wanted.params, weights)
    with blaming_the_command():
        by = shipped_rules() if rules is None else CutRules.from_toml(rules)
        wanted.check()
    waiting.doing(f"planning cuts on {source}")
    plan = cut_file(wanted, by)
    if output is not None:
        write_plan(output, plan)
    waiting.tell([plan.model_dump_json()] if json else lines_of(plan))


@app.command(rich_help_panel=TREES)
def convert(
    ctx: typer.Context,
    source: Annotated[Path, typer.Argument(help="A skeleton (.json, .swc) or a point cloud.")],
    target: Annotated[Path, typer.Argument(help="What to write; the ending says which kind.")],
    unit: UnitOfFile = None,
    cloud: Annotated[
        Path | None, typer.Option(help="The cloud, to go into a bag (.mcap) with the tree.")
    ] = None,
    cuts: Annotated[
        Path | None, typer.Option(help="Its plan (see `prunus cuts`), to go into the bag as poses.")
    ] = None,
) -> None:
    """Convert skeletons and clouds to what others read.

    Skeletons: .json .swc .ply .dxf .graphml .glb .gltf .obj .mtg .cylinders.csv .treeqsm.csv
    .txt (raycloudtools) .mcap (ROS 2). Clouds: .ply .xyz .txt .csv .npy .npz. What a kind of file
    cannot hold is said.

    For CloudCompare, as coloured lines: `prunus convert out/refined.json tree.dxf`

    For Blender, thick as it is: `prunus convert out/refined.json tree.glb`

    For RViz or Foxglove: `prunus convert out/refined.json tree.mcap`

    A cloud for another tool: `prunus convert tree.laz tree.xyz`
    """
    from prunus.commands.convert import convert_file

    waiting: Waiting = ctx.obj
    waiting.doing(f"converting {source}")
    for note in convert_file(source, target, unit and unit.value, cloud, cuts):
        waiting.say(f"{target}: {note}")


@app.command(rich_help_panel=TREES)
def fuse(
    ctx: typer.Context,
    rig: Annotated[Path, typer.Argument(help="Folder with rig.json, or with *_cloud.ply.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Cloud to write, as .ply.")],
    report: Annotated[
        Path | None, typer.Option(help="Write refined poses and residuals as JSON.")
    ] = None,
) -> None:
    """Fuse depth images or partial clouds of a rig to one cloud.

    Refines their poses together. docs/fuse.md describes rig.json. A view that does not fit the
    others is left out, and said.

    A rig to try it on: `prunus simulate -n 1 -o rig --views`

    Its views: `prunus fuse rig/tree_000000 -o raw.ply`
    """
    from prunus.commands.fuse import fuse_folder, lines_of

    waiting: Waiting = ctx.obj
    waiting.doing(f"fusing the views in {rig}")
    fused = fuse_folder(rig, output, report)
    waiting.tell([*lines_of(fused), f"{len(fused.xyz)} points written to {output}"])


@app.command(rich_help_panel=TREES)
def studio(
    ctx: typer.Context,
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
    frame: FrameOfFile = Frame.AUTO,
    unit: UnitOfFile = None,
    seed: Seed = 0,
    params: ParamsFile = None,
) -> None:
    """Look at trees, clean, correct and label them, on a page in the browser.

    A folder of scans: `prunus studio scans/ -o work`

    On another machine, here by `ssh -t -L 8080:localhost:8080 there`: `prunus studio scans/
    --no-open`
    """
    waiting: Waiting = ctx.obj
    waiting.doing(f"opening {path}")
    from prunus.session import Settings
    from prunus.studio.start import open_studio

    settings = Settings(
        frame=frame.value, unit=unit and unit.value, seed=seed,
        params=_parameters(params, None, False),
    )  # fmt: skip

    def say(line: str) -> None:
        waiting.rest()
        waiting.tell([line])

    open_studio(path, output, settings, host, port, token, not no_open, say)


@app.command(rich_help_panel=TREES)
def demo(
    ctx: typer.Context, output: OutputFolder = Path("prunus-out/demo"), seed: Seed = 0
) -> None:
    """Grow a tree, scan it, skeletonize the scan, compare with the truth.

    Another seed, another tree: `prunus demo --seed 7`
    """
    from prunus.commands.demo import compare, simulated_scan
    from prunus.commands.skeletonize import Options, Task

    waiting: Waiting = ctx.obj
    waiting.doing("growing and scanning a tree")
    truth = simulated_scan(output, seed)
    base = tuple(truth.xyz[0].tolist())
    options = Options(base, "z-up", seed=seed)
    _report(waiting, [Task(output / "scan.ply", output)], [], options, False, 1)
    waiting.tell([*compare(output, truth), f"  now open {output / 'report.html'}"])


@app.command(rich_help_panel=LEARNING)
def simulate(
    ctx: typer.Context,
    output: OutputFolder,
    trees: Annotated[int, typer.Option("-n", "--trees", min=1, help="How many trees.")] = 30,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first; the next has the next.")] = 0,
    scan: Annotated[
        ScanKind, typer.Option(help=f"{SCANS}; any: of any tree, scanner and surroundings.")
    ] = ScanKind.HARD,
    views: Annotated[bool, typer.Option("--views", help="Write the depth images too.")] = False,
    jobs: Jobs = CORES,
) -> None:
    """Grow an orchard and scan it: clouds, the truth of each point, skeletons.

    Thirty trees to learn from or to judge by: `prunus simulate -n 30 -o orchard`
    """
    from functools import partial

    from prunus.lab.simulate import simulate_scan
    from prunus.lab.simulate.orchard import simulate_orchard
    from prunus.lab.simulate.wide.scan import simulate_wide

    if views and scan == ScanKind.ANY:
        raise OptionError("--views: only of the rig; expected --scan ordinary, hard or clean")
    setting: Any = scan.value
    make = simulate_wide if scan == ScanKind.ANY else partial(simulate_scan, setting=setting)
    waiting: Waiting = ctx.obj
    made = simulate_orchard(output, range(seed, seed + trees), make, views, min(jobs, trees))
    for _ in waiting.watch(made, "trees", trees):
        pass
    waiting.tell([f"{trees} trees written to {output}"])


@app.command(rich_help_panel=LEARNING)
def train(
    ctx: typer.Context,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Weights to write (.onnx); a folder for field.")
    ],
    folders: Annotated[
        list[Path] | None, typer.Argument(help="Simulated scans, or the studio's folders.")
    ] = None,
    network: Annotated[
        Network,
        typer.Option(help="edges: those of the paper's method; field: of points."),
    ] = Network.EDGES,
    start: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="Go on from: paper, shipped (field), a file, scratch. "
            "[default: paper with labels]",
        ),
    ] = None,
    scans: Scans = None,
    seed: Seed = 0,
    epochs: Annotated[int | None, typer.Option(min=1, help="[default: as the recipe]")] = None,
    recipe: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="Of field: TOML. [default: the shipped]"),
    ] = None,
    jobs: Jobs = CORES,
) -> None:
    """Learn a network from scans with their truth, and print how well it does.

    From simulated trees: `prunus train orchard -o mine.onnx`

    From edges labelled in the studio: `prunus train prunus-studio -o mine.onnx`

    To use it: `prunus skeletonize tree.ply --weights mine.onnx`

    The point field, again to go on: `prunus train --network field -o run`
    """
    waiting: Waiting = ctx.obj
    if network == Network.FIELD:
        if epochs is not None or seed:
            raise OptionError("--network field: seed and steps stand in its recipe: see --recipe")
        waiting.tell(_field_trained(waiting, folders or [], output, recipe, start, scans, jobs))
        return
    if recipe is not None:
        raise OptionError(f"--recipe: of no use with --network {network.value}; expected field")
    if not folders:
        raise OptionError("no folder to learn from: expected simulated scans, or the studio's")
    waiting.doing("loading torch", at_once=True)
    from prunus.lab.learn.edges.school import Course, lines_of, school

    course = Course(start, seed, epochs, scans)
    waiting.tell(lines_of(school(folders, output, course, jobs, waiting.watch)))


def _field_trained(
    waiting: Waiting,
    folders: list[Path],
    output: Path,
    recipe: Path | None,
    start: str | None,
    scans: Path | None,
    jobs: int,
) -> list[str]:
    """Train the network of the point field; what to say of it."""
    from prunus.lab.learn.field.recipe import recipe_of

    with blaming_the_command():
        settings = recipe_of(recipe)
    waiting.doing("loading torch", at_once=True)
    try:
        from prunus.lab.learn.field.school import FieldCourse, field_school
    except ImportError as error:
        raise OptionError("training needs torch and onnx: pip install 'prunus[train]'") from error
    from prunus.lab.experiment.gold import corrected_in

    corrected = []
    for folder in folders:
        done, in_work = corrected_in(folder, scans)
        corrected += done
        for name in in_work:
            waiting.say(f"{folder / name}: not marked as done, so left out")
    course = FieldCourse(
        folder=output, recipe=settings, corrected=corrected, start=start, jobs=jobs
    )
    return field_school(course, waiting.watch, waiting.say)


@app.command(rich_help_panel=LEARNING)
def evaluate(
    ctx: typer.Context,
    skeleton: Annotated[Path, typer.Argument(help="A skeleton, or a folder of them.")],
    gold: Annotated[Path, typer.Argument(help="Its gold standard, or a folder of them.")],
    json: Annotated[bool, typer.Option("--json", help="One line of JSON a pair.")] = False,
    csv: Annotated[Path | None, typer.Option(help="Write a table, one row a pair.")] = None,
) -> None:
    """Measure skeletons against gold standards: what was found, what is right.

    Reads skeletons of other tools too (PLY edges, SWC, OBJ lines, GraphML), for the geometry.

    One pair: `prunus evaluate out/skeleton.json gold.json`

    Two folders: `prunus evaluate out orchard --csv measures.csv`
    """
    from json import dumps

    from prunus.commands.evaluate import compare, pairs_in, spread_lines, strangers
    from prunus.files.safely import write_bytes
    from prunus.io.tables import csv_bytes

    waiting: Waiting = ctx.obj
    pairs = pairs_in(skeleton, gold)
    records = [compare(*pair) for pair in waiting.watch(pairs, "pairs", len(pairs))]
    if csv is not None:
        write_bytes(csv, csv_bytes(records))
    waiting.tell(map(dumps, records) if json else spread_lines(records))
    hints = strangers(pairs, records)
    for hint in hints:
        waiting.say(hint)
    if len(hints) == len(records):
        raise typer.Exit(Status.FAILED)


@app.command(rich_help_panel=LEARNING)
def experiment(
    ctx: typer.Context,
    output: OutputFolder,
    trees: Annotated[int, typer.Option(min=1, help="How many trees.")] = 29,
    draws: Annotated[int, typer.Option(min=1, help="Draws of 50 000 points a tree.")] = 3,
    scan: Annotated[OrchardKind, typer.Option(help=f"{SCANS}.")] = OrchardKind.HARD,
    seed: Seed = 0,
    gold: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            file_okay=False,
            help="Your own trees in place of simulated ones: the studio's work folder.",
        ),
    ] = None,
    scans: Scans = None,
    ablation: Annotated[
        bool, typer.Option("--ablation", help="Also what each part brings, one at a time.")
    ] = False,
    jobs: Jobs = CORES,
) -> None:
    """Run the paper's result section on simulated trees or your own.

    Writes tables, figures, a page. Stopped half way, the same command goes on where it was.

    A quick look: `prunus experiment -o out --trees 6 --draws 1`

    On trees corrected in the studio: `prunus experiment --gold prunus-studio -o out`
    """
    from prunus.lab.experiment.results import Orchard, experiment, lines_of

    waiting: Waiting = ctx.obj
    with blaming_the_command():
        if gold is None:
            orchard = Orchard.simulated(trees, scan.value, seed)
        else:
            orchard = Orchard.corrected(gold, scans)
    results = experiment(output, orchard, draws, ablation, jobs, waiting.watch)
    waiting.tell([*lines_of(results), "", f"written to {output / 'index.html'}"])


@app.command(rich_help_panel=SHIPPED)
def rules(ctx: typer.Context) -> None:
    """Print the pruning rules that are shipped, as `cuts --rules` reads them.

    To change them: `prunus rules > mine.toml`
    """
    from prunus.cuts.settings import SHIPPED as FILE

    ctx.obj.tell(FILE.read_text(encoding="utf-8").splitlines())


@app.command(rich_help_panel=SHIPPED)
def params(
    ctx: typer.Context,
    method: Annotated[str, typer.Argument(help="default, or paper: as the paper has it.")] = (
        "default"
    ),
) -> None:
    """Print the parameters of a method with symbol, unit and range, as `--params` reads them.

    To change them: `prunus params > mine.toml`

    Those of the paper: `prunus params paper`
    """
    from prunus.params import GROUPS, Parameters

    if method not in GROUPS:
        raise OptionError(f"{method}: no method; expected default or paper")
    ctx.obj.tell(Parameters(method=method).to_toml().splitlines())


@app.command(rich_help_panel=SHIPPED)
def schema(
    ctx: typer.Context,
    name: Annotated[str | None, typer.Argument(help="Which one. [default: list them]")] = None,
) -> None:
    """Print the JSON Schema of a file or of a line that prunus writes.

    Which there are: `prunus schema`

    That of `skeletonize --json`: `prunus schema skeletonize`
    """
    from prunus.schemas import ABOUT, text_of

    if name is None:
        ctx.obj.tell(f"{one:<12} {about}" for one, about in ABOUT.items())
    else:
        ctx.obj.tell(text_of(name).splitlines())


def _network(weights: Path | None) -> NetworkScorer | None:
    """A network of one's own; OptionError where it is none, before anything is done."""
    if weights is None:
        return None
    from prunus.paper.networks import NetworkScorer

    network = NetworkScorer(weights)
    with blaming_the_command():
        network.check()
    return network


def _check_use(params: Parameters, weights: Path | None) -> None:
    """Raise OptionError where weights were given that are of no use to the method."""
    from prunus.params import SCORES_NOTHING

    if weights is not None and params.method == "default":
        raise OptionError(f"--weights: {SCORES_NOTHING}")


def _parameters(path: Path | None, points: str | None, no_isolate: bool) -> Parameters:
    from prunus.params import GONE, GROUPS, Parameters

    with blaming_the_command():
        if path is None:
            params = Parameters()
        elif str(path) in (*GROUPS, GONE) and not path.exists():
            params = Parameters(method=str(path))
        else:
            params = Parameters.from_toml(path)
        if no_isolate:
            params = params.changed("isolation", isolate="never")
        if points is None:
            return params
        if points not in ("all", "none") and not points.isdigit():
            raise PrunusError(f"--points: {points!r}; expected a number or 'all'")
        return params.changed("input", points=int(points) if points.isdigit() else points)


def _report(
    waiting: Waiting, tasks: list[Any], failed: list[Any], options: Any, as_json: bool, jobs: int
) -> None:
    """Run the tasks, say what came of each, and exit with 1 if any failed."""
    from prunus.commands.progress import Teller
    from prunus.commands.skeletonize import run

    teller = Teller(waiting, as_json)
    for record in failed:
        teller.tell(record)
    if len(tasks) == 1:
        waiting.doing(f"working on {tasks[0].path}")
    else:
        waiting.doing("trees", len(tasks))
    for record in run(tasks, options, jobs):
        teller.tell(record)
    teller.sum_up()
    if teller.failures:
        raise typer.Exit(Status.FAILED)


def main() -> None:
    """Run the command line; a closed pipe and signals end it quietly, any other fault in words."""
    end_on_signals()
    try:
        app()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(Status.FAILED)
    except Exception as error:  # a fault of ours is said in one line, with how to see more of it
        typer.echo(f"prunus: {describe(error)}", err=True)
        sys.exit(Status.FAILED)


if __name__ == "__main__":
    main()
