"""Names of groups: any text, reversibly, and nothing that HDF5 takes for a path."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tethertest.store.names import decoded, encoded, plain


@given(st.text(alphabet=st.characters()))
def test_any_name_comes_back(name: str) -> None:
    assert decoded(encoded(name)) == name


@given(st.text(alphabet="a/.%2EF\0 拉", max_size=6), st.text(alphabet="a/.%2EF\0 拉", max_size=6))
def test_different_names_stay_different_and_are_no_paths(one: str, other: str) -> None:
    assert (encoded(one) == encoded(other)) == (one == other)
    assert "/" not in encoded(one)
    assert encoded(one) not in {"", ".", ".."}
    assert encoded(one).isascii()


@pytest.mark.parametrize("name", ["tension_top", "F top (1)", "fbg-3.x"])
def test_common_names_stay_readable(name: str) -> None:
    assert encoded(name) == name


def test_text_that_hdf5_cannot_hold_gets_a_visible_substitute() -> None:
    assert plain("a\0b\ud800") == "a\u2400b?"
