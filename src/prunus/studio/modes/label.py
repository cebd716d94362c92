"""Label: one candidate edge at a time, valid or not, the uncertain first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import viser
from numpy.typing import NDArray

from prunus import __version__
from prunus.editing import Rebuild
from prunus.errors import PrunusError
from prunus.files.work_folder import LABELS
from prunus.io.labels import CATEGORIES, Category, LabelHead
from prunus.model import ScoredGraph
from prunus.paper.candidates import find_candidates
from prunus.paper.confidence import score_edges
from prunus.paper.images import edge_images
from prunus.paper.networks import NetworkScorer
from prunus.session import Work
from prunus.studio.modes.mode import Key, Mode
from prunus.studio.picking import Ray, nearest_edge
from prunus.studio.queue import Queue
from prunus.studio.scene import PICKED, Wishes
from prunus.studio.words import block, quiet

AROUND = 0.35
"""So many metres around the edge are in view."""
REACH = 10.0
"""An edge is meant so many pixels beside it."""
PIXELS = 12
"""A bin of the edge image is drawn so large."""


class Label(Mode):
    """Asks for a verdict on an edge, writes it down, and goes on to the next."""

    name = "Label"

    def build(self) -> None:
        """Make the controls."""
        gui = self.desk.gui
        self.queue: Queue | None = None
        self.before: Wishes | None = None
        self.images: NDArray[np.float32] | None = None
        self.text = gui.add_html("")
        self.image = gui.add_image(_drawn(np.zeros((16, 32), np.float32)), format="png")
        self._group("Is it wood?", {"valid": self._says(True), "not valid": self._says(False)},
                    "V, X")  # fmt: skip
        words = {word.replace("_", " "): self._says(True, word) for word in CATEGORIES}
        self._group("Valid, and", words, "Keys 1 to 5")
        self._group("Go", {"back": self._back, "skip": self._skip, "take back": self._take_back},
                    "B, N, backspace")  # fmt: skip

    def keys(self) -> list[Key]:
        """A verdict a key."""
        kinds = [
            Key(key=str(n), text=f"Valid: {word.replace('_', ' ')}", does=self._says(True, word))
            for n, word in enumerate(CATEGORIES, 1)
        ]
        return [
            Key(key="V", text="Valid", does=self._says(True)),
            Key(key="X", text="Not valid", does=self._says(False)),
            *kinds,
            Key(key="B", text="Back", does=self._back),
            Key(key="N", text="Skip", does=self._skip),
            Key(key="backspace", text="Take the label back", does=self._take_back),
        ]

    def enter(self) -> None:
        """Nothing but the points and the edge is shown."""
        self.before = self.desk.show.wishes
        self.desk.picked = None
        self.desk.show.want(replace(self.before, layers=frozenset({"points"})))

    def leave(self) -> None:
        """What was shown before is shown again."""
        if self.before is not None:
            self.desk.show.want(self.before)
            self._unmark()
        self.before = self.queue = None

    def _unmark(self) -> None:
        self.desk.painter.mark("asked", np.zeros((0, 2, 3)), PICKED, 6.0)
        self.desk.painter.places("asked-ends", np.zeros((0, 3)), PICKED)

    def redraw(self) -> None:
        """The queue of a tree that has been opened."""
        if self.before is None or self.desk.tree.work is None:
            return
        if self.queue is None:
            self.desk.try_to(self._begin)

    def _begin(self) -> None:
        assert self.desk.tree.work is not None
        self.queue = queue_of(self.desk.tree.work)
        self.images = edge_images(self.queue.graph.candidates)
        self._show()

    def clicked(self, ray: Ray, screen: tuple[float, float]) -> None:
        """The candidate edge at the ray is asked for next."""
        queue = self._queue()
        edge = nearest_edge(ray, _ends(queue.graph), REACH)
        if edge is not None:
            queue.jump(edge)
            self._show()

    def _says(self, valid: bool, category: Category | None = None) -> Callable[[], None]:
        def say() -> None:
            self.desk.tree.own()
            self._queue().say(valid, category)
            self._show()
            self.desk.folder.tell()

        return say

    def _back(self) -> None:
        self._queue().back()
        self._show()

    def _skip(self) -> None:
        self._queue().skip()
        self._show()

    def _take_back(self) -> None:
        self.desk.tree.own()
        self._queue().say(None, None)
        self._show()

    def _queue(self) -> Queue:
        if self.queue is None:
            raise PrunusError("the tree is not open yet")
        return self.queue

    def _show(self) -> None:
        """The edge in question, in the scene and as the network sees it."""
        queue = self._queue()
        edge = queue.edge
        ends = _ends(queue.graph)[edge]
        assert self.images is not None
        self.image.image = _drawn(self.images[edge])
        self.desk.painter.mark("asked", ends[None], PICKED, 6.0)
        self.desk.painter.places("asked-ends", ends, PICKED, 0.006)
        self.desk.frame(ends.min(axis=0) - AROUND, ends.max(axis=0) + AROUND)
        sure = float(queue.graph.confidence[edge])
        length = 100 * float(np.linalg.norm(ends[1] - ends[0]))
        self.text.content = block(
            f"<b>{len(queue.given)}</b> of {len(queue.graph.edges)} edges labelled",
            f"this one: {queue.verdict(edge)}",
            quiet(f"the machine's confidence {sure:.2f}, {length:.0f} cm; from the side:"),
        )

    def _group(self, label: str, does: dict[str, Callable[[], None]], hint: str) -> None:
        group: viser.GuiButtonGroupHandle = self.desk.gui.add_button_group(
            label, tuple(does), hint=hint
        )
        group.on_click(lambda event: self.desk.try_to(does[event.target.value]))


def queue_of(work: Work) -> Queue:
    """The queue of a tree that is open: all candidate edges, those too doubtful to search in too.

    Raises PrunusError where training could not make the graph again.
    """
    if work.settings.params.method == "default":
        raise PrunusError(
            "candidate edges are of the paper's method alone: to label them open the scan with "
            "--params paper and another --output"
        )
    state = work.state
    rebuilt = any(isinstance(act, Rebuild) for act in work.acts[: work.position])
    if rebuilt and not state.marked:
        raise PrunusError("the tree was built again from another base; undo that to label edges")
    head = LabelHead.model_validate(
        {
            "input": work.scan.record,
            "params": work.settings.params.model_dump(),
            "seed": work.settings.seed,
            "frame": work.settings.frame,
            "unit": work.settings.unit,
            "base": work.base,
            "version_of_prunus": __version__,
        }
    )
    every = score_edges(find_candidates(state.result.graph.superpoints), NetworkScorer())
    return Queue.of(every, state.scan.to_input, work.folder / LABELS, head)


def _ends(graph: ScoredGraph) -> NDArray[np.float64]:
    """The ends (E, 2, 3) of all candidate edges."""
    return np.asarray(graph.xyz[graph.edges])


def _drawn(image: NDArray[np.float32]) -> NDArray[np.uint8]:
    """An edge image (16, 32) as a picture, dark where points are."""
    grey = (255 * (1 - np.clip(image, 0, 1) ** 0.6)).astype(np.uint8)
    large = np.kron(grey, np.ones((PIXELS, PIXELS), np.uint8))
    return np.repeat(large[..., None], 3, axis=2)
