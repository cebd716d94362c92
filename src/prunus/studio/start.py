"""`prunus studio`: start the server, say where the page is, open it, wait for a signal to end."""

from __future__ import annotations

import os
import sys
import threading
import webbrowser
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

from prunus.errors import OptionError
from prunus.session import Settings
from prunus.studio.shelf import items_in


def open_studio(
    path: Path,
    output: Path,
    settings: Settings,
    *,
    host: str,
    port: int,
    token: str | None,
    browser: bool,
    say: Callable[[str], None],
) -> None:
    """Serve the trees of a path until a signal ends it. Off this machine there is always a token.

    Raises PrunusError where there is nothing to open, or viser is not installed.
    """
    if find_spec("viser") is None:
        raise OptionError('prunus studio needs viser: pip install "prunus[studio]"')
    from prunus.studio.door import is_loopback, new_token
    from prunus.studio.server import Studio

    if token == "" or (token is None and not is_loopback(host)):
        token = new_token()
    studio = Studio(items_in(path, output), settings, host, port, token)
    try:
        for line in _told(studio.url, token, output):
            say(line)
        if browser and has_display():
            webbrowser.open(studio.url)
        threading.Event().wait()
    finally:
        studio.stop()


def has_display() -> bool:
    """Whether a browser could open a window here: not over ssh, not without a screen."""
    if "SSH_CONNECTION" in os.environ:
        return False
    return sys.platform in ("darwin", "win32") or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )


def _told(url: str, token: str | None, output: Path) -> list[str]:
    """What a person must know."""
    lines = [f"the studio is at {url}", f"the work is kept in {output}; Ctrl-C ends"]
    return lines if token is None else [*lines, f"token: {token}"]
