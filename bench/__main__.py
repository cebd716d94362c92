"""`python -m bench [CASE ...] [--save]`: measure, and compare with the committed baseline."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from bench.cases import CASES

BASELINE = Path(__file__).with_name("baseline.json")
TOLERANCE = {"s": 1.0, "ms": 1.0, "MB": 0.15, "ratio": 0.02}
"""How far a figure may move before it is marked: the speed of shared machines halves at times."""


def main() -> None:
    """Measure the named cases, or all; `--save` makes the figures the baseline."""
    wanted = [word for word in sys.argv[1:] if word != "--save"] or list(CASES)
    unknown = set(wanted) - set(CASES)
    if unknown:
        sys.exit(f"bench: unknown case {min(unknown)!r}; expected {', '.join(CASES)}")
    baseline = json.loads(BASELINE.read_text()) if BASELINE.exists() else {}
    for case in wanted:
        for name, value, unit in CASES[case]():
            print(f"{name:<52} {value:10.4g} {unit:<5} {_against(baseline.get(name), value)}")
            sys.stdout.flush()
            baseline[name] = {
                "value": float(f"{value:.4g}"),
                "unit": unit,
                "better": "higher" if unit == "ratio" else "lower",
                "tolerance": TOLERANCE[unit],
            }
    if "--save" in sys.argv:
        BASELINE.write_text(json.dumps(baseline, indent=1) + "\n")


def _against(before: dict[str, Any] | None, value: float) -> str:
    if before is None:
        return ""
    change = value / before["value"] - 1
    worse = change if before["better"] == "lower" else -change
    mark = "  WORSE" if worse > before["tolerance"] else ""
    return f"{change:+.0%} of the baseline{mark}"


if __name__ == "__main__":
    main()
