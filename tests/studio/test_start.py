from importlib import util
from pathlib import Path

import pytest

from prunus.corrections import Settings
from prunus.errors import PrunusError
from prunus.studio import start
from prunus.studio.start import has_display, open_studio


def test_without_viser_the_command_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(start, "find_spec", lambda name: None)
    with pytest.raises(PrunusError, match=r'pip install "prunus\[studio\]"'):
        open_studio(tmp_path, tmp_path, Settings(), "127.0.0.1", 0, None, False, print)


def test_an_address_of_another_machine_is_refused(tmp_path: Path) -> None:
    if util.find_spec("viser") is None:
        pytest.skip("viser is not installed")
    (tmp_path / "a.ply").write_text("x")
    with pytest.raises(PrunusError, match="no address of this machine"):
        open_studio(tmp_path, tmp_path / "w", Settings(), "192.0.2.1", 0, None, False, print)


def test_no_browser_is_opened_over_ssh(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.delenv("SSH_CONNECTION", raising=False)
    assert has_display()
    monkeypatch.setenv("SSH_CONNECTION", "10.0.0.1 22 10.0.0.2 22")
    assert not has_display()
