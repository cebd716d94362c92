"""Radii from the widths of ribbons: what is told, what is usual, and what is neither."""

import numpy as np
import pytest

from prunus.model import Floats, Label
from prunus.refine.centrelines import Centrelines
from prunus.refine.radii import SHOWS, USUAL, WIDE, Unknown, tapers


def upright(*lengths: float) -> Centrelines:
    """Lines side by side, a station a centimetre."""
    size = [round(length / 0.01) + 1 for length in lengths]
    xyz = [np.column_stack([np.full(n, x), np.zeros(n), np.arange(n) * 0.01])
           for x, n in enumerate(size)]  # fmt: skip
    none = np.zeros(len(size), np.bool_)
    start = np.concatenate([[0], np.cumsum(size)])
    return Centrelines(
        xyz=np.concatenate(xyz),
        start=start,
        parent=np.full(len(size), -1),
        goes_on=none,
        free=~none,
    )


def ribbon(radius: Floats, noise: float, label: Label) -> Floats:
    """Half the widths that such radii show."""
    share = np.linspace(0, 1, len(radius))
    shown = noise * ((1 - share) * SHOWS[label][0] + share * SHOWS[label][1])
    return np.asarray(np.sqrt((radius / WIDE) ** 2 + shown**2))


def test_without_noise_the_widths_tell_the_radii() -> None:
    radius = np.linspace(0.016, 0.005, 101)
    found = tapers(upright(1.0), np.array([Label.LEADER]), ribbon(radius, 0, Label.LEADER))
    assert found.radius == pytest.approx(radius, abs=0.001)
    assert found.error.max() < 0.002
    assert (found.unknown == Unknown.KNOWN).all()


def test_the_noise_is_read_off_thin_wood_and_taken_out() -> None:
    labels = np.array([Label.SIDE_BRANCH, Label.TRUNK])
    thin, thick = np.linspace(0.005, 0.003, 41), np.linspace(0.040, 0.036, 51)
    half = [ribbon(thin, 0.010, Label.SIDE_BRANCH), ribbon(thick, 0.010, Label.TRUNK)]
    found = tapers(upright(0.4, 0.5), labels, np.concatenate(half))
    assert found.noise == pytest.approx(0.010, abs=0.0005)
    assert found.radius[41:] == pytest.approx(thick, rel=0.12)


def test_where_noise_hides_the_radius_it_is_the_usual_one_with_its_doubt() -> None:
    half = ribbon(np.linspace(0.005, 0.003, 41), 0.03, Label.SIDE_BRANCH)
    found = tapers(upright(0.4), np.array([Label.SIDE_BRANCH]), half)
    foot, doubt = USUAL[Label.SIDE_BRANCH][:2]
    assert found.radius[0] == pytest.approx(foot, abs=0.0005)
    assert found.error[0] > 0.8 * doubt


def test_a_branch_never_widens_outward() -> None:
    half = ribbon(np.linspace(0.006, 0.014, 101), 0, Label.LEADER)
    found = tapers(upright(1.0), np.array([Label.LEADER]), half)
    assert (np.diff(found.radius) <= 1e-12).all()


def test_few_widths_are_no_radius() -> None:
    half = np.full(101, np.nan)
    half[:2] = 0.01
    found = tapers(upright(1.0), np.array([Label.LEADER]), half)
    assert (found.unknown == Unknown.FEW_POINTS).all()


def test_ragged_widths_are_no_radius() -> None:
    half = ribbon(np.linspace(0.032, 0.026, 101), 0, Label.TRUNK)
    half[::2] += 0.02
    found = tapers(upright(1.0), np.array([Label.TRUNK]), half)
    assert (found.unknown == Unknown.RAGGED).all()


def test_far_from_any_width_there_is_no_radius() -> None:
    half = ribbon(np.linspace(0.012, 0.006, 101), 0, Label.LEADER)
    half[40:] = np.nan
    found = tapers(upright(1.0), np.array([Label.LEADER]), half)
    assert (found.unknown[:50] == Unknown.KNOWN).all()
    assert (found.unknown[60:] == Unknown.FAR_FROM_POINTS).all()
