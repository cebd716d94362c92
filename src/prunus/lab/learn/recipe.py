"""The recipe of a training, and the folder that is for one recipe alone."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, model_validator

from prunus.errors import PrunusError
from prunus.files.reading import json_of, read_text, read_toml, record_of
from prunus.files.safely import write_bytes
from prunus.lab.simulate.habits import Group

KEPT = "recipe.json"

Count = Annotated[int, Field(ge=0)]
Positive = Annotated[int, Field(ge=1)]
Rate = Annotated[float, Field(gt=0)]
Share = Annotated[float, Field(ge=0, le=1)]


class Scans(Group):
    """How many scans of the wide orchard and of the rig, from which seeds on."""

    wide: Count
    first_wide: Count
    rig: Count
    first_rig: Count
    clean_every: Positive

    def __len__(self) -> int:
        return self.wide + self.rig

    @property
    def wide_seeds(self) -> range:
        """The seeds of the wide orchard."""
        return range(self.first_wide, self.first_wide + self.wide)

    @property
    def rig_seeds(self) -> range:
        """The seeds of the rig."""
        return range(self.first_rig, self.first_rig + self.rig)

    def is_clean(self, number: int) -> bool:
        """Whether the rig's scan of that number, counted from 0, is one without faults."""
        return number % self.clean_every == self.clean_every - 1


class Steps(Group):
    """How many steps, one scan each, and the highest learning rate."""

    steps: Positive
    rate: Rate


class Corrected(Group):
    """How much trees count that a person corrected."""

    share: Share


class Recipe(Group):
    """What a network learns from, and for how long: see `owner.toml`."""

    seed: Count
    examples: Scans
    held_out: Scans
    from_scratch: Steps
    going_on: Steps

    @model_validator(mode="after")
    def _makes_sense(self) -> Recipe:
        if not len(self.examples):
            raise ValueError("examples: none; expected some scans to learn from")
        for name in ("wide_seeds", "rig_seeds"):
            one, other = (getattr(own, name) for own in (self.examples, self.held_out))
            if set(one) & set(other):
                raise ValueError(f"held_out: {name} that are learned from; expected others")
        return self


class FieldRecipe(Recipe):
    """The same of the network of the point field: see `field.toml`."""

    corrected: Corrected


RECIPES: dict[str, type[Recipe]] = {"field": FieldRecipe, "owner": Recipe}


def shipped_recipe(network: str) -> Path:
    """The file of the recipe that ships for a network."""
    return Path(__file__).parent / network / f"{network}.toml"


def recipe_of(path: Path | None, network: str = "field") -> Recipe:
    """The recipe in a file, None = the shipped one; PrunusError naming file and field."""
    path = path or shipped_recipe(network)
    return record_of(RECIPES[network], read_toml(path), path)


def claim(folder: Path, made_from: dict[str, Any]) -> None:
    """Make a folder one of this recipe, and of all else that the training is made from.

    PrunusError where it is one of another.
    """
    path = folder / KEPT
    if not path.exists():
        write_bytes(path, (json.dumps(made_from, indent=1) + "\n").encode())
        return
    there = json_of(read_text(path), path)
    differing = differences(there, json.loads(json.dumps(made_from)))
    if differing:
        raise PrunusError(
            f"{folder}: holds a training of another recipe ({'; '.join(differing[:3])}); expected "
            "the same recipe to go on with, or another folder to begin anew"
        )


def differences(there: Any, here: Any, name: str = "") -> list[str]:
    """What differs between two values of JSON, in words."""
    if not (isinstance(there, dict) and isinstance(here, dict)):
        return [] if there == here else [f"{name or 'it'}: {there} there, {here} asked for"]
    found = []
    for key in sorted({*there, *here}):
        own = f"{name}.{key}" if name else key
        found += differences(there.get(key), here.get(key), own)
    return found
