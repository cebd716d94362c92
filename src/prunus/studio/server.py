"""The server of the studio: where it listens, and a desk for each browser that may come in."""

from __future__ import annotations

import contextlib
import io
import socket
import threading
import warnings

import viser

from prunus.errors import OptionError
from prunus.session import Settings
from prunus.studio.camera import FOV
from prunus.studio.desk import Desk
from prunus.studio.door import Door, is_loopback, own_page
from prunus.studio.shelf import Item
from prunus.studio.tree import Tree


class _Server(viser.ViserServer):
    """Viser without its tunnel to the world, which any page could ask for."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Nothing is shared."""
        return None


class Studio:
    """The trees of a path on a page; `token` is asked for where one is given."""

    def __init__(
        self, items: list[Item], settings: Settings, host: str, port: int, token: str | None
    ) -> None:
        """Raises PrunusError where nothing can listen on that address."""
        _check_address(host)
        warnings.filterwarnings("ignore", "Queued a .* on a closed connection")
        self.loopback = is_loopback(host)
        self.trees = [Tree(item, settings) for item in items]
        self.door = Door(token)
        self.lock = threading.Lock()
        self.desks: dict[int, Desk] = {}
        self.last = 0
        with contextlib.redirect_stdout(io.StringIO()):
            self.server = _Server(host=host, port=port, label="prunus studio", verbose=False)
        self.host, self.port = host, self.server.get_port()
        self.server.gui.configure_theme(show_logo=False, show_share_button=False)
        self.server.initial_camera.fov = FOV
        self.server.on_client_connect(self._came)
        self.server.on_client_disconnect(self._went)

    @property
    def url(self) -> str:
        """Where the page is."""
        host = {"0.0.0.0": "localhost", "::": "localhost"}.get(self.host, self.host)
        return f"http://{f'[{host}]' if ':' in host else host}:{self.port}"

    def stop(self) -> None:
        """Send all away and let go of every tree."""
        for desk in list(self.desks.values()):
            desk.close()
        with contextlib.redirect_stdout(io.StringIO()):
            self.server.stop()
        for tree in self.trees:
            tree.close()

    def _came(self, client: viser.ClientHandle) -> None:
        connection = self.server._websock_server._live_connections.get(client.client_id)
        headers = connection.request.headers if connection and connection.request else {}
        if own_page(headers.get("Origin"), headers.get("Host"), self.loopback):
            self.door.ask(client, self._seat)

    def _seat(self, client: viser.ClientHandle) -> None:
        """A desk for a browser, at the tree that was looked at last."""
        desk = Desk(client, self.trees, self.last)
        with self.lock:
            self.desks[client.client_id] = desk

    def _went(self, client: viser.ClientHandle) -> None:
        with self.lock:
            desk = self.desks.pop(client.client_id, None)
        if desk is not None:
            self.last = desk.number
            desk.close()


def _check_address(host: str) -> None:
    """Raise PrunusError where no server can listen on an address."""
    try:
        family, kind, _, _, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind) as probe:
            probe.bind(address)
    except OSError as error:
        text = f"--host {host}: no address of this machine ({error.strerror})"
        raise OptionError(text) from error
