"""The states of one tree, act by act: near ones in memory, older ones worked out again."""

from __future__ import annotations

from pathlib import Path

from prunus.editing.acts import Act, Rebuild, Search
from prunus.editing.state import Chain, State, apply
from prunus.errors import PrunusError
from prunus.model import Floats, PointCloud
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.result import Result
from prunus.session.graphs import FIRST, Graphs
from prunus.session.sources import skeleton_digest, superpoints_digest
from prunus.session.timeline import Line, Timeline

KEPT = 100
"""So many states up to the one asked for stay in memory."""


class History:
    """A timeline, and the state after each of its acts; `graphs` keeps what took long."""

    def __init__(self, first: State, timeline: Timeline, graphs: Graphs) -> None:
        self.timeline = timeline
        self.graphs = graphs
        self._states = {0: first}

    @property
    def state(self) -> State:
        """The state after the acts that stand."""
        return self.at(self.timeline.position)

    def at(self, position: int) -> State:
        """The state after so many acts."""
        known = max(k for k in self._states if k <= position)
        state = self._states[known]
        for k in range(known, position):
            state = apply(state, self._act(k), self._chain(k))
            self._keep(k + 1, state, position)
        return state

    def add(self, line: Line, state: State) -> None:
        """One line more, which gave this state."""
        if not isinstance(line.move, str):
            here = self.timeline.position
            self._states = {k: held for k, held in self._states.items() if k <= here}
        self.timeline = self.timeline.after(line)
        self._keep(self.timeline.position, state, self.timeline.position)

    def _keep(self, position: int, state: State, near: int) -> None:
        """Hold a state; forget such as are far before `near`, save those that took long."""
        self._states[position] = state
        for k in [k for k in self._states if 0 < k < near - KEPT]:
            if not isinstance(self._act(k - 1), Rebuild | Search):
                del self._states[k]

    def keep(self) -> None:
        """Keep what the machine made of the scan, first and whenever the tree was built again.

        Raises PrunusError where it cannot be written.
        """
        if FIRST not in self.graphs:
            self.graphs.keep(FIRST, self.at(0).result)
        for k, line in enumerate(self.timeline.lines[: self.timeline.position]):
            if isinstance(line.move, Rebuild) and line.number not in self.graphs:
                self.graphs.keep(line.number, self.at(k + 1).result)

    def _chain(self, number: int) -> Chain:
        """The chain, or what it gave when an act was done."""
        line = self.timeline.lines[number]

        def fits(result: Result) -> bool:
            return line.gives in (None, superpoints_digest(result))

        def chain(cloud: PointCloud, base: Floats | None, params: Parameters, seed: int) -> Result:
            kept = self.graphs.later(line.number, cloud, params, seed, fits)
            return skeletonize(cloud, base, params, seed) if kept is None else kept

        return chain

    def _act(self, number: int) -> Act:
        move = self.timeline.lines[number].move
        assert not isinstance(move, str)
        return move

    def replay(self, path: Path) -> list[str]:
        """Do all acts that stand, as a journal has them; notes where they give something else.

        Raises PrunusError naming file and line where an act cannot be done, or where the chain
        gave other superpoints than those that the acts after it name.
        """
        notes: list[str] = []
        for position, line in enumerate(self.timeline.lines[: self.timeline.position], 1):
            where = f"{path}:{line.number}"
            try:
                state = self.at(position)
            except PrunusError as error:
                raise PrunusError(f"{where}: {error}") from error
            if line.gives in (None, gives(line.move, state)):
                continue
            if isinstance(line.move, Rebuild):
                raise PrunusError(f"{where}: the chain now gives other superpoints; {OTHER}")
            if not notes:
                notes.append(f"{where}: gives another tree than when it was written; look it over")
        return notes


OTHER = (
    "the acts name superpoints by number and cannot be done again on others, and those they name "
    "were not kept beside it. Open it with the version of prunus that the journal names; "
    "corrected.json beside it holds what was done"
)
"""What to do about a journal that was made on other superpoints."""


def gives(move: object, state: State) -> str:
    """A digest of what an act gave: of `Rebuild` the superpoints, else tree, marks and status."""
    if isinstance(move, Rebuild):
        return superpoints_digest(state.result)
    skeleton = state.draft.skeleton().moved(state.scan.to_input)
    marks = state.kind.tobytes() if state.marked else b""
    return skeleton_digest(skeleton, marks, bytes([state.done]))
