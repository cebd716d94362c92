"""What the machine made of a scan, kept beside the journal whose acts name its superpoints.

graph.npz     what the journal was begun on
graph-7.npz   what line 7 of the journal, a rebuilding, gave

So a journal outlives the chain that it was begun on. A file that cannot be read, or does not fit
the journal, is passed over with a word, and the chain runs again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from prunus import __version__
from prunus.errors import PrunusError
from prunus.files.safely import remove
from prunus.files.work_folder import GRAPH
from prunus.frames.scan import Scan
from prunus.model import PointCloud
from prunus.model.cloud import middle_of
from prunus.params import Parameters
from prunus.result import Result
from prunus.session.graphfile import GraphFile, read_graph, write_graph

FIRST = 1
"""The line of the journal that says on what it was begun."""


class Graphs:
    """The files in one work folder; `notes` is what a person should know of them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.notes: list[str] = []
        self._held: set[int] = set()

    def path(self, line: int) -> Path:
        """Where that is kept which a line of the journal gave."""
        return self.folder / (GRAPH if line == FIRST else f"graph-{line}.npz")

    def first(
        self, scan: Scan, params: Parameters, seed: int, fits: Callable[[Result], bool]
    ) -> tuple[Scan, Result] | None:
        """What the journal was begun on, and the scan as it was turned then; None for none."""
        file = self._file(FIRST)
        if file is None:
            return None
        scan = _turned(scan, file)
        result = self._fitting(FIRST, file, scan.cloud, params, seed, fits)
        if result is None:
            return None
        of = file.record.version_of_prunus
        other = "" if of == __version__ else f" by prunus {of}; this is {__version__}"
        self.notes.append(
            f"superpoints and the machine's skeleton are those of {self.path(FIRST).name}, as "
            f"they were found when the work was begun{other}"
        )
        return scan, result

    def later(
        self,
        line: int,
        cloud: PointCloud,
        params: Parameters,
        seed: int,
        fits: Callable[[Result], bool],
    ) -> Result | None:
        """What a rebuilding in a line gave; None where that is not kept."""
        file = self._file(line)
        return None if file is None else self._fitting(line, file, cloud, params, seed, fits)

    def __contains__(self, line: int) -> bool:
        """Whether what a line gave is kept, as far as was looked."""
        return line in self._held

    def keep(self, line: int, result: Result) -> None:
        """Keep what a line gave. Raises PrunusError where it cannot be written."""
        write_graph(self.path(line), result)
        self._held.add(line)

    def forget(self) -> None:
        """Remove all files: they are of a journal that is begun anew."""
        for path in [self.path(FIRST), *self.folder.glob("graph-*.npz")]:
            remove(path)
        self._held.clear()

    def _file(self, line: int) -> GraphFile | None:
        if not self.path(line).exists():
            return None
        try:
            return read_graph(self.path(line))
        except PrunusError as error:
            self._pass_over(str(error))
            return None

    def _fitting(
        self,
        line: int,
        file: GraphFile,
        cloud: PointCloud,
        params: Parameters,
        seed: int,
        fits: Callable[[Result], bool],
    ) -> Result | None:
        """The result in a file, if it is what the journal says."""
        try:
            result = file.result(cloud, params, seed)
        except PrunusError as error:
            self._pass_over(str(error))
            return None
        if not fits(result):
            self._pass_over(f"{file.path}: is not what the journal was made on")
            return None
        self._held.add(line)
        return result

    def _pass_over(self, problem: str) -> None:
        note = f"{problem}; the chain was run again"
        if note not in self.notes:
            self.notes.append(note)


def _turned(scan: Scan, file: GraphFile) -> Scan:
    """The scan in the house frame in which it stood when the file was written."""
    turn, on_grid = file.to_house, file.record.origin == "grid"
    if on_grid and (turn == scan.cloud.to_input.rotation.T).all():
        return scan
    middle = None if on_grid else middle_of(scan.file.xyz @ turn.T)
    cloud = PointCloud.from_xyz(scan.file.xyz, "z-up", scan.file.rgb, turn, middle)
    return replace(scan, cloud=cloud)
