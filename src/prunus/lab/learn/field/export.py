"""The network of the point field as an ONNX file, for any number of voxels, and back."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import torch
from onnx import numpy_helper
from torch import Tensor, nn

from prunus.errors import PrunusError
from prunus.field.network import TABLES
from prunus.field.voxels import LEVELS, Voxels
from prunus.lab.learn.edges.start import onnx_graph
from prunus.lab.learn.field.net import FieldNet, Tables

PREFIX = "net."  # of the names of parameters in a file


class _Named(nn.Module):
    """The network with its tables one by one, in the order of `TABLES`."""

    def __init__(self, net: FieldNet) -> None:
        super().__init__()
        self.net = net

    def forward(self, features: Tensor, *tables: Tensor) -> Tensor:
        """The outputs (V, 13)."""
        neighbours, rest = tables[:LEVELS], tables[LEVELS:]
        outputs: Tensor = self.net(features, Tables(neighbours, rest[::2], rest[1::2]))
        return outputs


def field_onnx(net: FieldNet, example: Voxels) -> bytes:
    """The file; `example` are some voxels to walk over."""
    tables = Tables.of(example.levels)
    pairs = zip(tables.parent, tables.children, strict=True)
    shown = (
        torch.from_numpy(example.features()),
        *tables.neighbours,
        *(table for pair in pairs for table in pair),
    )
    held: Any = io.BytesIO()
    with warnings.catch_warnings():
        # The older exporter warns that there is a newer one, which needs one more package.
        warnings.simplefilter("ignore")
        torch.onnx.export(
            _Named(net).eval(), shown, held, input_names=["features", *TABLES],
            output_names=["outputs"], opset_version=18, dynamo=False,
            dynamic_axes={one: {0: f"rows of {one}"} for one in ("features", *TABLES, "outputs")},
        )  # fmt: skip
    return bytes(held.getvalue())


def parameters_of(path: Path, net: FieldNet) -> dict[str, Tensor]:
    """The parameters for a network in a file that `field_onnx` wrote.

    Raises PrunusError where the file holds no such network.
    """
    graph = onnx_graph(path)
    held = {one.name: numpy_helper.to_array(one) for one in graph.initializer}
    # Parameters that are alike are kept once.
    held |= {node.output[0]: held[node.input[0]] for node in graph.node
             if node.op_type == "Identity" and node.input[0] in held}  # fmt: skip
    found = {}
    for name, own in net.state_dict().items():
        there = held.get(PREFIX + name)
        if there is None or there.shape != tuple(own.shape):
            shape = "none" if there is None else list(there.shape)
            raise PrunusError(
                f"{path}: parameter {name}: {shape}; expected {list(own.shape)}, as in a network "
                "that `prunus train --network field` made"
            )
        found[name] = torch.from_numpy(np.array(there))
    return found
