"""Parameters: one place, read and written, typos refused."""

import json
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
        Parameters.paper().changed("search", K=77).changed("input", points="all"),
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
            "superpoints.r_sper: unknown parameter.*min_points, r_super",
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


OLDER: dict[str, dict[str, Any]] = {
    "input": {"points": 50_000, "draw": "points"},
    "isolation": {"isolate": "never"},
    "superpoints": {"r_super": 0.1, "place": "random", "along": 0.08, "across": 0.04},
    "confidence": {"alpha_conf": 0.4, "floor": 0.0, "edge_net": "paper"},
    "search": {"K": 500, "refine": False},
    "leaders": {"min_length": 0.0},
    "side_branches": {"turn_max": 1.5707963267948966, "several": False, "min_length": 0.1},
}
"""What files of 0.1 named of the paper's method, with what it had always."""


@pytest.mark.parametrize("named", [{"method": "paper"}, {}])
def test_a_file_of_01_with_the_papers_method_is_read_in_silence(named: dict[str, str]) -> None:
    search = OLDER["search"] | ({} if named else {"score": "paper"})
    assert Parameters.parse(OLDER | named | {"search": search}) == Parameters.paper()


@pytest.mark.parametrize(
    ("values", "where"),
    [
        ({"method": "learned"}, "method"),
        ({"method": "learned", "input": {"points": 9}}, "method"),
        ({"search": {"score": "learned", "K": 500}}, "search.score"),
    ],
)
def test_the_method_that_is_gone_is_said_to_be(values: dict[str, Any], where: str) -> None:
    gone = f"params: {where}: found 'learned', the method of prunus 0.1, which is gone since 0.2"
    with pytest.raises(PrunusError, match=f'{gone}; expected method = "default"'):
        Parameters.parse(values)
    assert Parameters.of_record(values, "tree.json") == Parameters()


@pytest.mark.parametrize(
    ("group", "key", "value"),
    [
        ("input", "draw", "space"),
        ("superpoints", "place", "axes"),
        ("confidence", "floor", "auto"),
        ("confidence", "floor", False),
        ("confidence", "edge_net", "ours"),
        ("search", "refine", True),
        ("search", "refine", 0),
        ("search", "score", "growth"),
        ("leaders", "min_length", 0.35),
        ("side_branches", "several", True),
    ],
)
def test_what_is_gone_is_named_with_its_file(
    group: str, key: str, value: object, tmp_path: Path
) -> None:
    path = tmp_path / "old.toml"
    path.write_text(f'method = "paper"\n[{group}]\n{key} = {json.dumps(value)}\n')
    with pytest.raises(
        PrunusError, match=rf"old.toml: {group}\.{key}: found .*gone since 0.2; leave"
    ):
        Parameters.from_toml(path)


def test_parameters_stored_beside_a_result_are_those_of_its_method() -> None:
    paper = Parameters.paper().changed("search", K=9)
    assert Parameters.of_record(paper.model_dump(), "tree.json") == paper
    with pytest.raises(PrunusError, match=r"tree\.json: serch: unknown parameter"):
        Parameters.of_record({"serch": {}}, "tree.json")


@pytest.mark.parametrize("method", ["nought", ["paper"], 5])
def test_a_method_that_is_none_is_refused(method: object) -> None:
    with pytest.raises(PrunusError, match="params: method: input should be 'default'"):
        Parameters.parse({"method": method})


def test_a_method_shows_only_the_groups_it_goes_by() -> None:
    for params in (Parameters(), Parameters.paper()):
        shown = re.findall(r"^\[(\w+)\]$", params.to_toml(), re.MULTILINE)
        assert tuple(shown) == GROUPS[params.method]
        assert list(params.model_dump()) == ["method", *shown]
