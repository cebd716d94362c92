"""Wires among wood, in fields drawn by hand."""

import numpy as np
import pytest

from prunus.field.votes import PointField
from prunus.field.wires import on_wires, without_wires
from prunus.model import Bools, Floats, Role

STEP_M = 0.01


def limb(
    start: Floats, end: Floats, radius: float, role: Role, rng: np.random.Generator
) -> PointField:
    """Voxels along a straight limb, seen with a little noise and told for what they are."""
    count = round(float(np.linalg.norm(end - start)) / STEP_M)
    xyz = start + np.linspace(0, 1, count)[:, None] * (end - start)
    chance = np.full((count, len(Role)), 0.02)
    chance[:, role] = 0.9
    way = np.tile((start - end) / np.linalg.norm(end - start), (count, 1))
    return PointField(
        xyz=xyz + rng.normal(0, 0.003, xyz.shape),
        count=np.ones(count, np.int64),
        role=chance,
        offset=np.zeros_like(xyz),
        radius=np.full(count, radius),
        toward_foot=way,
    )


def joined(*parts: PointField) -> PointField:
    """All in one field."""
    names = ("xyz", "count", "role", "offset", "radius", "toward_foot")
    return PointField(**{
        name: np.concatenate([getattr(part, name) for part in parts]) for name in names
    })  # fmt: skip


def scene(
    length: float = 3.0, radius: float = 0.004, role: Role = Role.LATERAL, rise: float = 0.0,
    turn: float = 0.0, bend: float = 0.0,
) -> tuple[PointField, Bools]:  # fmt: skip
    """Five uprights, and what runs across them; which voxels are of that."""
    rng = np.random.default_rng(4)
    half = length / 2
    middle = np.array([0.0, bend, 1.2 + rise * half])
    uprights = [
        limb(np.array([x, 0.0, 0.5]), np.array([x, 0.0, 2.4]), 0.01, Role.FRUITING_UNIT, rng)
        for x in np.linspace(-1.0, 1.0, 5)
    ]
    across = [
        limb(np.array([-half, 0.0, 1.2]), middle, radius, role, rng),
        limb(middle, np.array([half, 0.0, 1.2 + rise * length]), radius, role, rng),
    ]
    field = joined(*uprights, *across)
    turned = np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    rows = np.arange(len(field.xyz)) >= sum(len(one.xyz) for one in uprights)
    return PointField(
        xyz=field.xyz @ turned.T,
        count=field.count,
        role=field.role,
        offset=field.offset,
        radius=field.radius,
        toward_foot=field.toward_foot @ turned.T,
    ), rows


@pytest.mark.parametrize("turn", [0.0, 0.4, 1.5, 3.0])
@pytest.mark.parametrize("length", [1.8, 3.0, 6.0])
@pytest.mark.parametrize("rise", [0.0, 0.03])
def test_a_wire_is_found_whole_and_nothing_that_crosses_it(
    turn: float, length: float, rise: float
) -> None:
    field, wire = scene(length=length, turn=turn, rise=rise)
    found = on_wires(field, np.random.default_rng(0))
    assert found[wire].mean() > 0.98
    assert not found[~wire].any()


@pytest.mark.parametrize(
    "wood",
    [
        {"length": 1.2},
        {"radius": 0.014},
        {"role": Role.FRAMEWORK, "radius": 0.014},
        {"role": Role.STEM},
        {"rise": 0.2},
        {"bend": 0.15, "length": 2.6},
    ],
    ids=["short", "thick", "a support", "a stem", "steep", "bent"],
)  # fmt: skip
def test_wood_is_no_wire(wood: dict[str, float]) -> None:
    field, _ = scene(**wood)  # type: ignore[arg-type]
    assert not on_wires(field, np.random.default_rng(0)).any()


def test_what_lies_on_a_wire_is_no_wood_and_all_else_stays_as_it_was() -> None:
    field, wire = scene()
    told = without_wires(field, np.random.default_rng(0))
    assert np.median(told.role[wire, Role.NO_WOOD]) == 1.0
    assert np.array_equal(told.role[~wire], field.role[~wire])


@pytest.mark.parametrize("count", [0, 1, 20])
def test_hardly_any_voxels_hold_no_wire(count: int) -> None:
    field = scene()[0].take(np.arange(count))
    assert not on_wires(field, np.random.default_rng(0)).any()
