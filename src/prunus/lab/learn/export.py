"""A network as an ONNX file, for any number of rows, and back."""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from onnx import numpy_helper
from torch import Tensor, nn

from prunus.errors import PrunusError
from prunus.lab.learn.edges.start import onnx_graph

PREFIX = "net."  # of the names of parameters in a file


class Named(nn.Module):
    """A network whose parameters have names that begin with `PREFIX`, as in a file."""

    def __init__(self, net: nn.Module) -> None:
        super().__init__()
        self.net = net

    def forward(self, *inputs: Tensor) -> Tensor:
        """The outputs."""
        outputs: Tensor = self.net(*inputs)
        return outputs


def onnx_of(named: Named, example: Mapping[str, Tensor], output: str) -> bytes:
    """The file; `example` are some inputs by name, of any number of rows as the output is."""
    held: Any = io.BytesIO()
    with warnings.catch_warnings():
        # The older exporter warns that there is a newer one, which needs one more package.
        warnings.simplefilter("ignore")
        torch.onnx.export(
            named.eval(), tuple(example.values()), held, input_names=list(example),
            output_names=[output], opset_version=18, dynamo=False,
            dynamic_axes={one: {0: f"rows of {one}"} for one in (*example, output)},
        )  # fmt: skip
    return bytes(held.getvalue())


def parameters_of(path: Path, net: nn.Module, name: str) -> dict[str, Tensor]:
    """The parameters for a network of that name in a file that `onnx_of` wrote.

    Raises PrunusError where the file holds no such network.
    """
    graph = onnx_graph(path)
    held = {one.name: numpy_helper.to_array(one) for one in graph.initializer}
    # Parameters that are alike are kept once.
    held |= {node.output[0]: held[node.input[0]] for node in graph.node
             if node.op_type == "Identity" and node.input[0] in held}  # fmt: skip
    found = {}
    for key, own in net.state_dict().items():
        there = held.get(PREFIX + key)
        if there is None or there.shape != tuple(own.shape):
            shape = "none" if there is None else list(there.shape)
            raise PrunusError(
                f"{path}: parameter {key}: {shape}; expected {list(own.shape)}, as in a network "
                f"that `prunus train --network {name}` made"
            )
        found[key] = torch.from_numpy(np.array(there))
    return found
