"""Names of files, whatever bytes they are, as text that can be written and printed."""

import json
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prunus.errors import PrunusError, describe
from prunus.names import LONGEST_BYTES, as_text, folder_name, in_line

posix = pytest.mark.skipif(os.name != "posix", reason="names are bytes on POSIX alone")


@posix
@pytest.mark.parametrize(
    ("name", "text", "line"),
    [
        (b"tree.ply", "tree.ply", "tree.ply"),
        (b"\xc4pfel.ply", "%C4pfel.ply", "%C4pfel.ply"),
        ("Äpfel 桃.ply".encode(), "Äpfel 桃.ply", "Äpfel 桃.ply"),
        (b"two\nlines", "two\nlines", "two%0Alines"),
        (b"\x1b[2J\x07", "\x1b[2J\x07", "%1B[2J%07"),
        (b"\xe2\x80", "%E2%80", "%E2%80"),
    ],
)
def test_a_name_is_written_and_printed_as_utf8(name: bytes, text: str, line: str) -> None:
    path = Path("in") / os.fsdecode(name)
    assert as_text(path) == f"in/{text}"
    assert in_line(path) == f"in/{line}"
    assert str(PrunusError(f"{path}: bad")) == f"in/{line}: bad"


@posix
@given(st.binary(max_size=400).filter(lambda name: b"/" not in name and b"\0" not in name))
def test_whatever_its_name_a_folder_of_outputs_can_be_made_and_told(name: bytes) -> None:
    folder = folder_name(os.fsdecode(name))
    assert 0 < len(folder.encode("utf-8", "strict")) <= LONGEST_BYTES
    assert folder not in (".", "..") and "/" not in folder
    assert len(in_line(os.fsdecode(name)).splitlines()) <= 1
    assert json.loads(json.dumps(as_text(os.fsdecode(name))).encode("ascii")) is not None


def test_long_names_that_differ_only_at_the_end_give_two_folders() -> None:
    assert folder_name("n" * 300 + "a") != folder_name("n" * 300 + "b")


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (PrunusError("a.ply: bad\nand worse"), "a.ply: bad%0Aand worse"),
        (MemoryError(), "not enough memory"),
        (KeyError("x"), "internal error, please report it: KeyError: 'x' (PRUNUS_DEBUG=1 shows"),
        (RuntimeError("two\nlines"), "internal error, please report it: RuntimeError: two%0Alines"),
        (OSError("mine"), "internal error, please report it: OSError: mine"),
        (OSError(28, "No space left on device"), "No space left on device"),
        (OSError(5, "Input/output error", "a\nb.ply"), "a%0Ab.ply: Input/output error"),
    ],
)
def test_every_exception_is_described_in_one_line(error: Exception, text: str) -> None:
    assert describe(error).startswith(text)
