"""Who may come in: the same page only, and with the token where one is asked for."""

from __future__ import annotations

import hmac
import secrets
import threading
import time
from collections.abc import Callable
from ipaddress import ip_address
from urllib.parse import urlsplit

import viser

WAIT = 1.0
"""Seconds that a wrong token costs, one after another."""


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches a server on that address."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def new_token() -> str:
    """A token that nobody guesses."""
    return secrets.token_urlsafe(16)


def own_page(origin: str | None, asked: str | None, loopback: bool) -> bool:
    """Whether a connection comes from the studio's own page, by the headers Origin and Host.

    Another site that is open in the same browser may connect too: its origin is another. On
    loopback the name must be one of this machine, so that no name of another's can point here.
    """
    if origin is None or asked is None:
        return origin is None
    if urlsplit(origin).netloc.lower() != asked.lower():
        return False
    return not loopback or is_loopback(urlsplit(origin).hostname or "")


class Door:
    """Asks each browser for the token, in a modal, before anything of the data is sent."""

    def __init__(self, token: str | None) -> None:
        self.token = token
        self.turn = threading.Lock()

    def ask(self, client: viser.ClientHandle, enter: Callable[[viser.ClientHandle], None]) -> None:
        """Let the browser in once it has given the token."""
        if self.token is None:
            enter(client)
            return
        modal = client.gui.add_modal("prunus studio")
        with modal:
            given = client.gui.add_text("Token", "")
            told = client.gui.add_html("")
            button = client.gui.add_button("Open")

        @button.on_click
        def _(_: object) -> None:
            if self.fits(given.value):
                modal.close()
                enter(client)
            else:
                told.content = '<p style="padding:0 12px;color:#b45309">This is not the token.</p>'

    def fits(self, given: str) -> bool:
        """Whether it is the token; a wrong one costs time, also those who try side by side."""
        assert self.token is not None
        with self.turn:
            right = hmac.compare_digest(given.strip().encode(), self.token.encode())
            if not right:
                time.sleep(WAIT)
        return right
