"""Arrows go down only: the floor plan, asked of the import statements themselves."""

import ast
from pathlib import Path

import prunus

HOME = Path(prunus.__file__).parent
FLOORS = [
    {"cli"},
    {"commands"},
    {"batch", "lab", "studio"},
    {"report", "session"},
    {"cuts", "editing"},
    {"isolation", "pipeline"},
    {"frames", "method"},
    {"paper"},
    {"fusion", "growth", "schemas"},
    {"io", "result", "traits"},
    {"field", "refine", "rules", "trust"},
    {"geometry", "grammar", "params", "weights"},
    {"files", "model", "processes"},
    {"errors"},
    {"names"},
]
"""From the roof down. A room may use rooms on lower floors alone: no neighbour knows another."""


def floor_of(room: str) -> int:
    return next(number for number, rooms in enumerate(FLOORS) if room in rooms)


def imports(path: Path) -> set[str]:
    """The rooms of prunus that a file imports, wherever in the file."""
    rooms = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("prunus."):
            rooms.add((node.module or "").split(".")[1])
        elif isinstance(node, ast.Import):
            rooms |= {n.name.split(".")[1] for n in node.names if n.name.startswith("prunus.")}
    return rooms


def room_of(path: Path) -> str:
    return path.relative_to(HOME).parts[0].removesuffix(".py")


def test_every_room_stands_on_a_floor() -> None:
    rooms = {room_of(path) for path in HOME.rglob("*.py")} - {"__init__"}
    assert rooms == set().union(*FLOORS)


def test_the_default_knows_nothing_of_the_papers_method() -> None:
    for room in ("field", "growth", "result"):
        for path in [*HOME.glob(f"{room}/**/*.py"), *HOME.glob(f"{room}.py")]:
            assert "paper" not in imports(path), path


def test_arrows_go_down_only() -> None:
    wrong = []
    for path in sorted(HOME.rglob("*.py")):
        room = room_of(path)
        if room == "__init__":
            continue
        for used in imports(path) - {room}:
            if floor_of(used) <= floor_of(room):
                wrong.append(f"{path.relative_to(HOME)} imports {used}")
    assert wrong == []
