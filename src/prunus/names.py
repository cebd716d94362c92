"""Names of files as text that can be printed, and written as UTF-8.

On most disks a name is bytes, of any encoding. Python holds the bytes that are no UTF-8 as lone
surrogates, which neither JSON nor any other file of ours may hold.
"""

from __future__ import annotations

import hashlib
import re

LONGEST_BYTES = 255
"""Of a name, on all common disks."""
_LONE = re.compile("[\ud800-\udfff]")
_CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029]")


def as_text(name: object) -> str:
    """A name, a path or a text with names in it as valid UTF-8: a byte that is none as `%C4`."""
    return _LONE.sub(_percent, str(name))


def in_line(text: object) -> str:
    """The same on one line and harmless on a terminal: control characters as `%0A` too."""
    return _CONTROL.sub(_percent, as_text(text))


def _percent(one: re.Match[str]) -> str:
    return f"%{ord(one[0]) & 0xFF:02X}"


def folder_name(name: str) -> str:
    """What a folder of outputs is called after an input: valid UTF-8, and not too long."""
    text = as_text(name)
    if not text.strip("."):
        return f"_{text}"
    whole = text.encode()
    if len(whole) <= LONGEST_BYTES:
        return text
    mark = "~" + hashlib.sha256(whole).hexdigest()[:8]
    return whole[: LONGEST_BYTES - len(mark)].decode(errors="ignore") + mark
