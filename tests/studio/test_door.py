import time

import pytest

from prunus.studio import door
from prunus.studio.door import Door, is_loopback, new_token, own_page


def test_only_addresses_of_this_machine_are_loopback() -> None:
    assert all(is_loopback(host) for host in ("127.0.0.1", "localhost", "::1", "127.8.8.8"))
    assert not any(is_loopback(host) for host in ("0.0.0.0", "10.0.0.3", "example.org", ""))


def test_tokens_are_long_and_never_the_same() -> None:
    assert len({new_token() for _ in range(50)}) == 50
    assert len(new_token()) >= 20


def test_a_wrong_token_does_not_fit_and_costs_time(monkeypatch: pytest.MonkeyPatch) -> None:
    waited = list[float]()
    monkeypatch.setattr(door, "WAIT", 0.5)
    monkeypatch.setattr(time, "sleep", waited.append)
    asked = Door("right")
    assert not asked.fits("wrong") and not asked.fits("") and not asked.fits("ríght")
    assert waited == [0.5] * 3
    assert asked.fits(" right ") and len(waited) == 3


@pytest.mark.parametrize(
    ("origin", "host", "loopback", "own"),
    [
        ("http://127.0.0.1:8080", "127.0.0.1:8080", True, True),
        ("http://localhost:9000", "localhost:9000", True, True),
        ("https://evil.example", "127.0.0.1:8080", True, False),
        ("http://127.0.0.1:3000", "127.0.0.1:8080", True, False),
        ("http://evil.example:8080", "evil.example:8080", True, False),
        ("http://orchard.lan:8080", "orchard.lan:8080", False, True),
        ("null", "127.0.0.1:8080", True, False),
        (None, "127.0.0.1:8080", True, True),
    ],
)
def test_pages_of_other_sites_do_not_come_in(
    origin: str | None, host: str, loopback: bool, own: bool
) -> None:
    assert own_page(origin, host, loopback) is own
