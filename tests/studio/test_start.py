import os
import signal
import subprocess
import sys
from importlib import util
from pathlib import Path

import pytest

from prunus.errors import PrunusError
from prunus.session import Settings
from prunus.studio.start import has_display, open_studio
from tests.processes.children import child, prunus


def test_without_viser_the_command_says_what_to_install(tmp_path: Path) -> None:
    """In a process of its own, since here viser may be imported already."""
    line = "import sys; sys.modules['viser'] = None; from prunus.cli import main; main()"
    with child("-c", line, "studio", tmp_path, "--no-open", stderr=subprocess.PIPE) as process:
        _, said = process.communicate(timeout=60)
    assert 'prunus studio needs viser: pip install "prunus[studio]"' in said
    assert process.returncode == 2


def test_an_address_of_another_machine_is_refused(tmp_path: Path) -> None:
    if util.find_spec("viser") is None:
        pytest.skip("viser is not installed")
    (tmp_path / "a.ply").write_text("x")
    with pytest.raises(PrunusError, match="no address of this machine"):
        open_studio(
            tmp_path,
            tmp_path / "w",
            Settings(),
            host="192.0.2.1",
            port=0,
            token=None,
            browser=False,
            say=print,
        )


def test_no_browser_is_opened_over_ssh(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.delenv("SSH_CONNECTION", raising=False)
    assert has_display()
    monkeypatch.setenv("SSH_CONNECTION", "10.0.0.1 22 10.0.0.2 22")
    assert not has_display()


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_the_studio(number: signal.Signals, tmp_path: Path) -> None:
    pytest.importorskip("viser", reason="viser is not installed")
    (tmp_path / "a.ply").write_text("x")
    words = ["studio", tmp_path, "-o", tmp_path / "work", "--port", 0, "--no-open"]
    with prunus(*words) as server:
        assert "the studio is at http://127.0.0.1" in server.stdout.readline()
        server.send_signal(number)
        assert server.wait(60) == 128 + number
        assert "Traceback" not in server.stderr.read()


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_the_studio_of_a_script_in_the_background_ends_on_sigterm(tmp_path: Path) -> None:
    pytest.importorskip("viser", reason="viser is not installed")
    (tmp_path / "a.ply").write_text("x")
    words = 'studio "$1" -o "$1/work" --port 0 --no-open'
    line = f'"$0" -m prunus.cli {words} & echo $!; wait $!; echo $?'
    shell = "import os, sys; os.execvp('sh', ['sh', '-c', *sys.argv[1:]])"
    with child("-c", shell, line, sys.executable, tmp_path) as process:
        number, *told = (process.stdout.readline() for _ in range(3))
        assert "the studio is at" in told[0]
        os.kill(int(number), signal.SIGINT)
        os.kill(int(number), signal.SIGTERM)
        assert int(process.communicate(timeout=60)[0]) == 128 + signal.SIGTERM
