"""What the documentation shows runs, and what it points to exists."""

import re
from pathlib import Path

import pytest

from prunus.io.clouds.cloud_file import write_cloud
from tests.conftest import simulated

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
EXAMPLES = [
    (page.name, code)
    for page in PAGES
    for code in re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)
]


@pytest.mark.parametrize(("page", "code"), EXAMPLES)
def test_python_examples_run(
    page: str, code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    truth, cloud = simulated(2)
    write_cloud(tmp_path / "tree.ply", cloud.to_input.apply(cloud.xyz) - truth.xyz[0])
    monkeypatch.chdir(tmp_path)
    exec(compile(code, page, "exec"), {})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_and_named_files_exist(page: Path) -> None:
    text = page.read_text()
    for target in re.findall(r"\]\(([^)#]+)\)", text):
        assert target.startswith("http") or (page.parent / target).exists(), target
    for name in re.findall(r"`((?:[a-z]+/)*[a-z_]+\.py)`", text):
        assert (ROOT / "src" / "prunus" / name).exists() or (ROOT / name).exists(), name


def test_the_readme_shows_every_command() -> None:
    from typer.testing import CliRunner

    from prunus.cli import app

    help_text = CliRunner().invoke(app, ["--help"]).stdout
    for command in ("demo", "skeletonize", "isolate", "fuse", "simulate", "train", "convert"):
        assert command in help_text
        assert f"prunus {command}" in (ROOT / "README.md").read_text() or command == "demo"
