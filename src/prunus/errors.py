"""The one exception that the library raises on purpose."""


class PrunusError(ValueError):
    """Bad input: the message names the file or field, what was found and what was expected."""


class NoTreeError(PrunusError):
    """Nothing that can be a tree was found: the message says why, and what to try."""
