"""No process outlives the test that started it."""

import signal
import textwrap

import pytest

from tests.processes import children
from tests.processes.children import child


@pytest.mark.parametrize("ignored", [[], ["SIGINT"], ["SIGTERM"], ["SIGINT", "SIGTERM"]])
def test_a_child_ends_with_its_block_whatever_it_ignores(
    ignored: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(children, "GRACE_S", 0.2)
    code = f"""
    import signal, time
    for name in {ignored}:
        signal.signal(getattr(signal, name), signal.SIG_IGN)
    print("ready", flush=True)
    while True:
        time.sleep(1)
    """
    with child("-c", textwrap.dedent(code)) as process:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        assert process.poll() is None
    assert process.poll() is not None


def test_a_child_ends_when_its_test_fails() -> None:
    with pytest.raises(ZeroDivisionError), child("-c", "input()") as process:
        raise ZeroDivisionError
    assert process.poll() is not None


def test_a_child_hears_ctrl_c_where_its_parent_does_not() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        code = "import signal; print(signal.getsignal(signal.SIGINT).__name__)"
        with child("-c", code) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == "default_int_handler\n"
        assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
