"""Options that several commands share, each said once, and what they come to."""

from __future__ import annotations

import os
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prunus.errors import OptionError, PrunusError, blaming_the_command

if TYPE_CHECKING:
    from prunus.paper.networks import NetworkScorer
    from prunus.params import Parameters


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
    OWNER = "owner"


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


def network_in(weights: Path | None) -> NetworkScorer | None:
    """A network of one's own; OptionError where it is none, before anything is done."""
    if weights is None:
        return None
    from prunus.paper.networks import NetworkScorer

    network = NetworkScorer(weights)
    with blaming_the_command():
        network.check()
    return network


def check_use(params: Parameters, weights: Path | None) -> None:
    """Raise OptionError where weights were given that are of no use to the method."""
    from prunus.params import SCORES_NOTHING

    if weights is not None and params.method == "default":
        raise OptionError(f"--weights: {SCORES_NOTHING}")


def parameters_in(path: Path | None, points: str | None, no_isolate: bool) -> Parameters:
    """The parameters of a file or a method, with what options change of them; OptionError."""
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
