"""The networks that learn from simulated scans: that of the point field, and that of owners."""

from __future__ import annotations

from prunus.field import network
from prunus.growth import belonging
from prunus.lab.learn.field.examples import FieldExample
from prunus.lab.learn.field.judge import figures_of, table_of
from prunus.lab.learn.field.lessons import field_losses, field_onnx
from prunus.lab.learn.field.net import FieldNet
from prunus.lab.learn.owner.examples import OwnerExample
from prunus.lab.learn.owner.lessons import owner_figures, owner_losses, owner_onnx, owner_table
from prunus.lab.learn.owner.net import OwnerNet
from prunus.lab.learn.school import Learner

FIELD = Learner(
    name="field",
    shipped=network.SHIPPED,
    net=FieldNet,
    example=FieldExample,
    lesson=field_losses,
    onnx=field_onnx,
    figures=figures_of,
    table=table_of,
)
OWNER = Learner(
    name="owner",
    shipped=belonging.SHIPPED,
    net=OwnerNet,
    example=OwnerExample,
    lesson=owner_losses,
    onnx=owner_onnx,
    figures=owner_figures,
    table=owner_table,
)
LEARNERS = {one.name: one for one in (FIELD, OWNER)}
