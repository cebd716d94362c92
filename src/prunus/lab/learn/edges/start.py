"""Where training starts from: the parameters of a network that was exported before."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import onnx
import torch
from onnx import numpy_helper
from torch import nn

from prunus.errors import PrunusError
from prunus.files.safely import read_bytes
from prunus.lab.learn.edges.net import VALIDITY
from prunus.model import Floats

PREFIX = "net."
"""In a file the parameters have the names that they have within what is exported."""


def start_from(path: Path, net: nn.Module) -> nn.Module:
    """The edge network with the parameters of an ONNX file that `prunus train` wrote.

    The stretch and shift of its calibration are taken into the last layer, so that it says what the
    file says. Raises PrunusError where the file is no network of this kind.
    """
    graph = onnx_graph(path)
    _load(net, graph, path)
    _take_in(net, *_calibration(graph, path))
    return net


def _load(net: nn.Module, graph: Any, path: Path) -> None:
    held = _parameters(graph)
    wanted = {name: own for name, own in net.state_dict().items() if own.is_floating_point()}
    for name, own in wanted.items():
        if name not in held or held[name].shape != tuple(own.shape):
            found = list(held[name].shape) if name in held else "none"
            raise PrunusError(
                f"{path}: parameter {name}: {found}; expected {list(own.shape)}, as in a network "
                "of this kind that `prunus train` made"
            )
    state = {name: torch.from_numpy(np.array(held[name])) for name in wanted}
    net.load_state_dict(net.state_dict() | state)


def onnx_graph(path: Path) -> Any:
    """The graph of an ONNX file; PrunusError where it is none."""
    try:
        return onnx.load_model_from_string(read_bytes(path)).graph
    except Exception as error:
        # protobuf's own errors have no public name in all its versions
        if isinstance(error, PrunusError) or type(error).__name__ != "DecodeError":
            raise
        raise PrunusError(f"{path}: not an ONNX file ({type(error).__name__})") from error


def _parameters(graph: Any) -> dict[str, Floats]:
    """By name. A weight without one is known by the bias that is added to what it gives."""
    held = {one.name: numpy_helper.to_array(one) for one in graph.initializer}
    added = {
        name: node.input for node in graph.node if node.op_type == "Add" for name in node.input
    }
    for node in graph.node:
        if node.op_type == "MatMul" and node.input[1] in held:
            biases = [name for name in added.get(node.output[0], ()) if name.endswith(".bias")]
            held |= {bias[: -len("bias")] + "weight": held[node.input[1]].T for bias in biases}
    return {name.removeprefix(PREFIX): own for name, own in held.items() if name.startswith(PREFIX)}


def _calibration(graph: Any, path: Path) -> tuple[float, float]:
    """Stretch and shift: the numbers by which the last log odds are multiplied and added to."""
    constants = {
        node.output[0]: numpy_helper.to_array(node.attribute[0].t)
        for node in graph.node
        if node.op_type == "Constant"
    }
    made_by = {name: node for node in graph.node for name in node.output}
    try:
        shifted = made_by[made_by["confidence"].input[0]]
        (shift,) = (constants[name] for name in shifted.input if name in constants)
        (odds,) = (name for name in shifted.input if name not in constants)
        (stretch,) = (constants[name] for name in made_by[odds].input if name in constants)
    except (KeyError, ValueError) as error:
        raise PrunusError(f"{path}: no calibration in it; expected one as we write it") from error
    return float(stretch), float(shift)


@torch.no_grad()
def _take_in(net: nn.Module, stretch: float, shift: float) -> None:
    """Multiply and shift the log odds of validity in the last layer of a network."""
    last = [part for part in net.modules() if isinstance(part, nn.Linear)][-1]
    last.weight[:VALIDITY] *= stretch
    last.bias[:VALIDITY] *= stretch
    last.bias[VALIDITY - 1] += shift
