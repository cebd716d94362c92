"""JSON Schemas of what prunus writes and prints, one file a name beside this one.

They are made from the models in `io` by `python -m prunus.schemas.make`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from prunus.errors import OptionError

HOME = Path(__file__).parent
ABOUT = {
    "skeleton": "skeleton.json and refined.json",
    "plan": "plan.json, and the line of `prunus cuts --json`",
    "skeletonize": "a line of `prunus skeletonize --json`",
    "evaluate": "a line of `prunus evaluate --json`",
    "rig": "rig.json, which `prunus fuse` reads",
    "fused": "the report of `prunus fuse --report`",
    "status": "the exit status of every command",
}
"""What each schema is of."""


def text_of(name: str) -> str:
    """The file of a schema; PrunusError where no schema has that name."""
    if name not in ABOUT:
        raise OptionError(f"{name!r}: no such schema; expected one of {', '.join(ABOUT)}")
    return (HOME / f"{name}.json").read_text(encoding="utf-8")


def schema(name: str) -> dict[str, Any]:
    """The JSON Schema of a name in `prunus.schemas.ABOUT`; PrunusError where it is none."""
    return dict(json.loads(text_of(name)))
