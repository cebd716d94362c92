"""Parameters: one place, read and written, typos refused."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from prunus.errors import PrunusError
from prunus.params import GROUPS, Parameters


def test_the_papers_parameters_are_as_in_the_paper() -> None:
    params = Parameters.paper()
    assert params.superpoints.r_super == 0.10
    assert params.confidence.alpha_conf == 0.40
    assert params.tips.alpha_tip == 0.60
    assert (params.search.K, params.search.k_max_rep) == (500, 3)


def test_what_is_written_reads_back(tmp_path: Path) -> None:
    for params in (
        Parameters().changed("input", points="all"),
        Parameters.paper().changed("search", K=77, refine=False).changed("input", points="all"),
        Parameters.learned(),
    ):
        (tmp_path / "p.toml").write_text(params.to_toml())
        assert Parameters.from_toml(tmp_path / "p.toml") == params
        assert Parameters.parse(params.model_dump()) == params


@given(r=st.floats(0.01, 1), K=st.integers(1, 10_000))
def test_any_value_reads_back_exactly(r: float, K: int) -> None:
    import tomllib

    params = Parameters.paper().changed("superpoints", r_super=r).changed("search", K=K)
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
    path.write_text(f'method = "paper"\n{text}')
    with pytest.raises(PrunusError, match=f"wrong.toml: {message}"):
        Parameters.from_toml(path)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match=r"none.toml: cannot be read \(No such file"):
        Parameters.from_toml(tmp_path / "none.toml")


@pytest.mark.parametrize("number", [np.int64(9), np.uint8(9)])
def test_numbers_of_numpy_are_numbers(number: object) -> None:
    assert Parameters.paper().changed("search", K=number).search.K == 9


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Parameters(method="paper", search={"K": 0}), "params: search.K: .* found 0"),
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


def test_what_a_file_does_not_name_is_as_its_method_has_it() -> None:
    assert Parameters.parse({}) == Parameters()
    assert Parameters.parse({"method": "paper"}) == Parameters.paper()
    some = Parameters.parse({"method": "paper", "search": {"K": 9}})
    assert some == Parameters.paper().changed("search", K=9)


@pytest.mark.parametrize("group", [g for g in GROUPS["paper"] if g not in GROUPS["default"]])
def test_a_group_of_another_method_is_refused_by_its_name(group: str) -> None:
    other = Parameters.paper().model_dump()[group]
    with pytest.raises(PrunusError, match=rf"default.* does not go by \[{group}\].*paper"):
        Parameters.parse({group: other | {next(iter(other)): 0.5}})
    with pytest.raises(PrunusError, match=rf"\[{group}\]"):
        Parameters.parse({group: {}})


def older(method: str) -> dict[str, Any]:
    """All parameters, as files had them before there was `method`."""
    params = Parameters.parse({"method": method}).model_dump()
    del params["method"]
    params["search"]["score"] = method
    return params


@pytest.mark.parametrize("method", ["learned", "paper"])
def test_a_file_from_before_there_was_a_method_is_read_as_it_was_meant(method: str) -> None:
    assert Parameters.parse(older(method)) == Parameters.parse({"method": method})


def test_what_an_older_file_does_not_name_is_as_it_was_then() -> None:
    params = Parameters.parse({"search": {"score": "paper"}})
    then = Parameters.learned().model_dump() | {"method": "paper"}
    assert params == Parameters.parse(then)
    assert (params.input.points, params.superpoints.place) == (50_000, "axes")


def test_a_score_that_is_none_any_more_is_refused() -> None:
    with pytest.raises(PrunusError, match=r"search\.score: found 'growth'; expected no"):
        Parameters.parse({"search": {"score": "growth"}})


@pytest.mark.parametrize("method", ["nought", ["paper"], 5])
def test_a_method_that_is_none_is_refused(method: object) -> None:
    with pytest.raises(PrunusError, match="params: method: input should be 'default'"):
        Parameters.parse({"method": method})


def test_a_method_shows_only_the_groups_it_goes_by() -> None:
    for params in (Parameters(), Parameters.paper()):
        shown = re.findall(r"^\[(\w+)\]$", params.to_toml(), re.MULTILINE)
        assert tuple(shown) == GROUPS[params.method]
        assert list(params.model_dump()) == ["method", *shown]
