"""Networks in ONNX files, run by onnxruntime on one thread: the same answer every time."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from typing import Any

from prunus.errors import PrunusError
from prunus.files.reading import read_bytes

WEIGHTS = Path(__file__).parent
"""Where the networks lie that the package ships."""


@cache
def open_network(path: Path, inputs: tuple[frozenset[str], ...], outputs: frozenset[str]) -> Any:
    """An onnxruntime session of a network with one of these sets of inputs, and these outputs.

    Raises PrunusError where the file holds none.
    """
    # Newer ones keep a record of every session in the home of the user, and would send it out.
    os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    content = read_bytes(path)
    try:
        session = onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    except Exception as error:
        # the errors of onnxruntime share no class, and a damaged file may raise any of them
        raise PrunusError(f"{path}: not an ONNX file ({type(error).__name__})") from error
    names = {one.name for one in session.get_inputs()}
    found = {one.name for one in session.get_outputs()}
    if names not in inputs or found != outputs:
        raise PrunusError(
            f"{path}: a network from {sorted(names)} to {sorted(found)}; "
            "expected one that `prunus train` made"
        )
    return session
