"""The trees that a path names, each with the folder in which the work on it is kept."""

from __future__ import annotations

from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path

from prunus.errors import OptionError, PrunusError
from prunus.files.safely import check_readable
from prunus.files.work_folder import SKELETON
from prunus.io.inputs import clouds_in, is_one, names_of, source_of
from prunus.names import folder_name


@dataclass(frozen=True)
class Item:
    """A scan or skeleton, the name by which the page shows it, and the folder of the work on it."""

    name: str
    source: Path
    folder: Path


def items_in(path: Path, output: Path) -> list[Item]:
    """What a path holds: itself, or the clouds and the NAME/skeleton.json of a folder, by name.

    Raises PrunusError where there is nothing to open, or the work would be kept upon its source.
    """
    sources = _sources(path)
    if not sources:
        raise PrunusError(f"{path}: no point cloud and no NAME/{SKELETON} in this folder")
    names = _names(sources)
    items: list[Item] = []
    for name, source in sorted(zip(names, sources, strict=True), key=itemgetter(0)):
        name = folder_name(name)
        folder = output / name
        if folder.resolve() == source.parent.resolve():
            raise OptionError(f"{source}: lies where the work on it would be kept; say -o DIR")
        if folder not in [item.folder for item in items]:
            items.append(Item(name, source, folder))
    return items


def _sources(path: Path) -> list[Path]:
    """The inputs of a path, clouds first."""
    if path.suffix.lower() == ".json" or not path.is_dir():
        check_readable(source_of(path).path)
        return [path]
    try:
        if is_one(path):
            return [source_of(path).full]
        clouds = clouds_in(path)
        below = sorted(one / SKELETON for one in path.iterdir() if one.is_dir())
        own = [path / SKELETON] if (path / SKELETON).is_file() and not clouds else []
        return clouds + own + [one for one in below if one.is_file()]
    except OSError as error:
        raise PrunusError(f"{path}: cannot be read ({error.strerror})") from error


def _names(sources: list[Path]) -> list[str]:
    """The name of each source; a NAME/skeleton.json has that of its folder."""
    clouds = [path for path in sources if path.suffix.lower() != ".json"]
    known = dict(zip(clouds, names_of(clouds), strict=True))
    return [known[path] if path in known else _skeleton_name(path) for path in sources]


def _skeleton_name(path: Path) -> str:
    return path.resolve().parent.name if path.name == SKELETON else path.stem
