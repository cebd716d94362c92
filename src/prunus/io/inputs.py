"""What may be named as an input: a cloud file, a bag, a topic of a bag, a folder of any of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from prunus.errors import PrunusError
from prunus.files.reading import read_bytes
from prunus.files.work_folder import GRAPH, JOURNAL, MASK, SCAN, TREES, TRUTH
from prunus.io.clouds.readers import READERS
from prunus.io.clouds.text import may_be_cloud

BAGS = (".bag", ".mcap", ".db3")
"""Endings of recordings: ROS 1, and the two stores of ROS 2."""

WORDY = (".txt", ".csv", ".asc")
"""Endings that notes and tables have too: in a folder, such a file without points is no scan."""

ONE_TREE = {"cloud_final.ply": (), SCAN: (TREES, TRUTH)}
"""Clouds that stand for their folder, and beside which of these files (none: always)."""


OF_WORK = (MASK, GRAPH, "graph-*.npz")
"""Files beside the journal of a tree that are no scans: see docs/studio.md."""


@dataclass(frozen=True)
class Source:
    """A file or bag, and the topic in it that was asked for, if any."""

    path: Path
    topic: str | None = None

    @property
    def full(self) -> Path:
        """The path with the topic, as a user would write it."""
        return self.path if self.topic is None else Path(f"{self.path}#{self.topic}")

    @property
    def name(self) -> str:
        """The last part of the path, with the topic."""
        return self.path.name if self.topic is None else f"{self.path.name}#{self.topic}"


def source_of(path: Path) -> Source:
    """What a path names: `bag.mcap#/points` is a topic of a bag, unless a file is called so.

    No topic holds that mark, so the last one counts. The folder of one tree names its cloud
    (see `tree_in`), and so does any other that holds but one. PrunusError where the path cannot be
    looked at.
    """
    try:
        there = path.exists()
    except OSError as error:
        raise PrunusError(f"{path}: cannot be read ({error.strerror})") from error
    if there:
        return Source(tree_in(path) or _only_in(path) or path)
    bag, _, topic = path.as_posix().rpartition("#")
    if bag and topic and is_bag(Path(bag)):
        return Source(Path(bag), topic)
    return Source(path)


def is_bag(path: Path) -> bool:
    """Whether a path is that of a recording: by its ending, or a folder with ROS 2's metadata."""
    with suppress(OSError, PrunusError):
        if not path.is_dir():
            return path.suffix.lower() in BAGS
        return b"rosbag2_bagfile_information" in read_bytes(path / "metadata.yaml")
    return False


def tree_in(folder: Path) -> Path | None:
    """The cloud that stands for the folder of one tree: the data set's, or a simulated scan."""
    with suppress(OSError):
        for name, beside in ONE_TREE.items():
            known = not beside or any((folder / other).is_file() for other in beside)
            if known and (folder / name).is_file():
                return folder / name
    return None


def _only_in(folder: Path) -> Path | None:
    """The one cloud or bag of a folder that is none itself."""
    with suppress(OSError):
        inside = clouds_in(folder) if folder.is_dir() and not is_bag(folder) else []
        return inside[0] if len(inside) == 1 else None
    return None


def is_one(path: Path) -> bool:
    """Whether a path names one input: a file, a bag, or the folder of one tree."""
    return not path.is_dir() or is_bag(path) or tree_in(path) is not None


def clouds_in(folder: Path) -> list[Path]:
    """The inputs that a folder holds, by name.

    A bag is itself, the folder of one tree its cloud. Elsewhere clouds and bags right inside, and
    what of its folders is a bag or one tree; neither hidden ones nor notes. OSError where it cannot
    be looked into.
    """
    if is_one(folder):
        return [tree_in(folder) or folder]
    inside = sorted(folder.iterdir())
    return [tree_in(path) or path for path in inside if _is_input(path)]


def _is_input(path: Path) -> bool:
    """Whether something in a folder is an input; a link that leads nowhere is one that fails."""
    if path.name.startswith(".") or path.is_dir() or (path.exists() and not path.is_file()):
        return path.is_dir() and not path.name.startswith(".") and is_one(path)
    if any(path.match(name) for name in OF_WORK) and (path.parent / JOURNAL).is_file():
        return False
    ending = path.suffix.lower()
    return ending in (*READERS, *BAGS) and (ending not in WORDY or may_be_cloud(path))


def names_of(paths: list[Path]) -> list[str]:
    """A name for each input: its own, or where that is not its alone, with its folder's.

    A cloud that stands for its folder has the folder's name.
    """
    names = [_own(path) for path in paths]
    longer: tuple[Callable[[Path], str], ...] = (
        _above,
        lambda path: f"{_above(path)}_{_own(path)}",
    )
    for name in longer:
        shared = {name for name, count in Counter(names).items() if count > 1}
        names = [
            name(path) if own in shared else own for own, path in zip(names, paths, strict=True)
        ]
    return names


def _own(path: Path) -> str:
    thing = _thing(path)
    return _called(thing) if thing.is_dir() else thing.stem


def _above(path: Path) -> str:
    """The next longer name: the topic's for a topic, else that of the folder it lies in."""
    topic = source_of(path).topic
    if topic is not None:
        return f"{_own(path)}_{topic.strip('/').replace('/', '_')}"
    return _called(_thing(path).parent)


def _thing(path: Path) -> Path:
    """The file or bag, or the folder that it stands for."""
    file = source_of(path).path
    return file.parent if file.name in ONE_TREE and file.parent.name else file


def _called(folder: Path) -> str:
    """The name of a folder, also of `.` and `..`."""
    return folder.name if folder.name not in ("", "..") else folder.resolve().name
