"""The package imports what it declares: a plain install lacks nothing, and drags nothing in."""

import ast
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import prunus

HOME = Path(prunus.__file__).parent
PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]
BROUGHT_BY = packages_distributions()
OWN_WORDS = {"all", "dev"}
"""Extras that gather others, or what only we need."""


def names_in(requirements: list[str]) -> set[str]:
    """The names in requirements, without extras, versions and markers."""
    return {re.match(r"[\w.-]+", one)[0].lower() for one in requirements}  # type: ignore[index]


def declared() -> set[str]:
    """What a user gets with every extra."""
    extras = [one for name in EXTRAS.keys() - OWN_WORDS for one in EXTRAS[name]]
    return names_in(PROJECT["dependencies"] + extras)


def packages_in(path: Path) -> set[str]:
    """The top-level packages that a file imports or looks for, wherever in the file."""
    found = {
        name.split(".")[0] for node in ast.walk(ast.parse(path.read_text())) for name in asked(node)
    }
    return found - sys.stdlib_module_names - {"prunus"}


def asked(node: ast.AST) -> list[str]:
    """The modules that a statement or call asks for."""
    match node:
        case ast.Import():
            return [alias.name for alias in node.names]
        case ast.ImportFrom():
            return [node.module or ""]
        case ast.Call(func=ast.Name(id="find_spec"), args=[ast.Constant(value=str(name))]):
            return [name]
    return []


def distributions_of(package: str) -> set[str]:
    """What brings a package; one that is not installed is taken to be called like it."""
    return {name.lower() for name in BROUGHT_BY.get(package, [package])}


def test_every_import_is_declared() -> None:
    undeclared = [
        f"{path.relative_to(HOME)} imports {package}"
        for path in sorted(HOME.rglob("*.py"))
        for package in sorted(packages_in(path))
        if not distributions_of(package) & declared()
    ]
    assert undeclared == []


def test_everything_declared_is_used() -> None:
    packages = set[str]().union(*map(packages_in, HOME.rglob("*.py")))
    used = set[str]().union(*map(distributions_of, packages))
    assert declared() <= used


def test_all_is_every_extra_but_training_which_drags_in_a_gigabyte() -> None:
    (everything,) = EXTRAS["all"]
    inside = set(everything.removeprefix("prunus[").removesuffix("]").split(","))
    assert inside == EXTRAS.keys() - OWN_WORDS - {"train"}
