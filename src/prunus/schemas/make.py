"""Makes the schemas from the models: `python -m prunus.schemas.make` after a model was changed."""

from __future__ import annotations

import json
from typing import Any

from pydantic import BaseModel

from prunus.errors import Status
from prunus.io.records import FusedFile, PairRecord, TreeRecord
from prunus.io.rig import RigFile
from prunus.io.skeletons.plans import PlanFile
from prunus.io.skeletons.skeleton_file import SkeletonFile
from prunus.schemas import ABOUT, HOME

VERSION = 1
"""Of each schema; one is raised when what was valid under the version before no longer is."""
MODELS: dict[str, type[BaseModel]] = {
    "skeleton": SkeletonFile,
    "plan": PlanFile,
    "skeletonize": TreeRecord,
    "evaluate": PairRecord,
    "rig": RigFile,
    "fused": FusedFile,
}


PRINTED = ("skeletonize", "evaluate", "fused")
"""What prunus writes and never reads."""


def made(name: str) -> str:
    """The text of a schema."""
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:prunus:schema:{name}:{VERSION}",
        "version": VERSION,
        "title": f"prunus: {ABOUT[name].replace('`', '')}",
    }
    held = _schema_of(name) if name in MODELS else _statuses()
    return json.dumps(head | {key: held[key] for key in held if key != "title"}, indent=2) + "\n"


def _schema_of(name: str) -> dict[str, Any]:
    """What is only printed has every field; what is read may leave out those with a default."""
    return MODELS[name].model_json_schema(mode="serialization" if name in PRINTED else "validation")


def _statuses() -> dict[str, Any]:
    known = [{"const": int(one), "title": one.name, "description": one.about} for one in Status]
    return {"description": "What each exit status says.", "oneOf": known}


if __name__ == "__main__":
    for each in ABOUT:
        (HOME / f"{each}.json").write_text(made(each), encoding="utf-8")
