"""The public list is what the documentation says, sorted, and every name loads."""

import subprocess
import sys

import pytest

import prunus


def test_the_names_are_sorted_and_documented() -> None:
    assert list(prunus.__all__) == sorted(prunus.__all__)
    for name in prunus.__all__:
        assert getattr(prunus, name).__doc__


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="attribute skeletonise"):
        _ = prunus.skeletonise


def test_importing_prunus_loads_nothing_heavy() -> None:
    code = "import sys, prunus; print({'numpy', 'numba', 'plotly'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
