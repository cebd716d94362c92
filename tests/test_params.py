"""Parameters: one place, read and written, typos refused."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from prunus.errors import PrunusError
from prunus.params import Parameters


def test_the_defaults_are_the_papers() -> None:
    params = Parameters()
    assert params.superpoints.r_super == 0.10
    assert params.confidence.alpha_conf == 0.40
    assert params.tips.alpha_tip == 0.60
    assert (params.search.K, params.search.k_max_rep) == (500, 3)


def test_what_is_written_reads_back(tmp_path: Path) -> None:
    params = Parameters().changed("search", K=77, refine=False).changed("input", points="all")
    (tmp_path / "p.toml").write_text(params.to_toml())
    assert Parameters.from_toml(tmp_path / "p.toml") == params


@given(r=st.floats(0.01, 1), K=st.integers(1, 10_000))
def test_any_value_reads_back_exactly(r: float, K: int) -> None:
    import tomllib

    params = Parameters().changed("superpoints", r_super=r).changed("search", K=K)
    assert Parameters.parse(tomllib.loads(params.to_toml())) == params


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "[superpoints]\nr_sper = 0.1",
            "superpoints.r_sper: unknown parameter.*min_points, place, r_super",
        ),
        ("[serch]\nK = 1", "serch: unknown parameter; expected one of confidence"),
        ("[search]\nK = 0", "search.K: input should be greater than or equal to 1; found 0"),
        ("[search]\nK = 'many'", "search.K: .*valid integer.*found 'many'"),
        ("[turn]\nc = nan", "turn.c: .*finite"),
        ("[side_branches]\nangle_min = 3.0", "side_branches: angle_min 3.0 is over angle_max"),
        ("[input]\npoints = 'some'", "input.points"),
        ("[search", "not a TOML file"),
        ("[search]\nK = true", "search.K: input should be no truth value"),
        (
            "[superpoints]\nr_super = 1e-300",
            "superpoints.r_super: .* greater than or equal to 0.01",
        ),
        ("[superpoints]\nr_super = 1e300", "superpoints.r_super: .* less than or equal to 1"),
        ("[superpoints]\nalong = 0", "superpoints.along: .* greater"),
        ("[superpoints]\nacross = -1", "superpoints.across: .* greater"),
        ("[confidence]\nalpha_conf = 0.9999999999999999", "confidence.alpha_conf: .* 0.99"),
        ("[search]\nK = 1000000000", "search.K: .* less than or equal to 100000"),
        ("[turn]\np = inf", "turn.p: .*finite"),
        ("search = 5", "search: input should be a valid dictionary.*found 5"),
        ("\0", "holds zero bytes"),
    ],
)
def test_a_wrong_file_is_refused_by_name(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(PrunusError, match=f"wrong.toml: {message}"):
        Parameters.from_toml(path)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match=r"none.toml: cannot be read \(No such file"):
        Parameters.from_toml(tmp_path / "none.toml")


@pytest.mark.parametrize("number", [np.int64(9), np.uint8(9)])
def test_numbers_of_numpy_are_numbers(number: object) -> None:
    assert Parameters().changed("search", K=number).search.K == 9


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Parameters(search={"K": 0}), "params: search.K: .* found 0"),
        (lambda: Parameters(serch={}), "params: serch: unknown parameter"),
        (lambda: Parameters().changed("serch", K=1), "params: serch: unknown parameter"),
        (lambda: Parameters.parse({1: 2}), "params: 1: unknown parameter"),
        (lambda: Parameters.parse(None), "params: input should be a valid dictionary"),
        (lambda: Parameters.from_toml(5), "params: 5; expected the name of a file"),
    ],
)
def test_python_gets_the_same_refusals(make: Callable[[], object], says: str) -> None:
    with pytest.raises(PrunusError, match=says):
        make()
