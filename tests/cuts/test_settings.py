"""The rules' file: what it may leave out, what it may not hold."""

from pathlib import Path

import pytest

from prunus.cuts import CutRules, shipped_rules
from prunus.errors import PrunusError


def written(folder: Path, text: str) -> Path:
    (folder / "mine.toml").write_text(text)
    return folder / "mine.toml"


def test_a_file_names_only_what_differs(tmp_path: Path) -> None:
    rules = CutRules.from_toml(written(tmp_path, "[side_branches]\nlonger_than = 0.30\n"))
    ours = shipped_rules()
    assert rules.side_branches.longer_than == 0.30
    assert rules.side_branches.stub == ours.side_branches.stub
    assert (rules.spacing, rules.height, rules.review) == (ours.spacing, ours.height, ours.review)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "[side_branches]\nlonger = 1\n",
            "side_branches.longer: unknown key; expected one of apply",
        ),
        ("[thinning]\nclosest = 1\n", "thinning: unknown key; expected one of height, review"),
        ("[spacing]\nclosest = -1\n", "spacing.closest: input should be greater than 0; found -1"),
        ("[side_branches]\nstub = 0.2\n", "stub 0.2 is not under longer_than 0.15"),
        ("[height]\nto = 3\n", "height: to 3.0 is above over 2.4"),
        ("spacing = 3\n", "spacing: "),
        ("[spacing\n", "not a TOML file"),
    ],
)
def test_what_no_rule_knows_is_an_error_that_names_it(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match=r"mine\.toml: ") as error:
        CutRules.from_toml(written(tmp_path, text))
    assert said in str(error.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match=r"gone\.toml: cannot be read"):
        CutRules.from_toml(tmp_path / "gone.toml")
