"""The network of the point field as an ONNX file, for any number of voxels."""

from __future__ import annotations

import io
import warnings
from typing import Any

import torch
from torch import Tensor, nn

from prunus.field.network import TABLES
from prunus.field.voxels import LEVELS, Voxels
from prunus.lab.learn.field_net import FieldNet, Tables


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
