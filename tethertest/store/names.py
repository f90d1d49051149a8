"""Names of channels and clocks as names of HDF5 groups, and back."""

from __future__ import annotations

from urllib.parse import quote, unquote

#: what stays as it is in a group's name; every program and every shell takes these
_PLAIN = " ()[]+,@#="
#: stands for the empty name, which HDF5 does not have
_EMPTY = "%"


def encoded(name: str) -> str:
    """Return a group's name for any text: what HDF5 or MATLAB would trip over is percent-encoded UTF-8.

    Parameters
    ----------
    name : str
        Slashes, dots, NUL and any script are allowed; different names stay different.
    """
    if not name:
        return _EMPTY
    text = quote(name, safe=_PLAIN, errors="surrogatepass")
    # "." and ".." are places in an HDF5 path
    return text.replace(".", "%2E") if not text.strip(".") else text


def decoded(name: str) -> str:
    """Return the text that a group's name stands for; the inverse of `encoded`."""
    return "" if name == _EMPTY else unquote(name, errors="surrogatepass")


def plain(text: str) -> str:
    """Return text that an HDF5 string can hold: NUL and halves of surrogate pairs get visible substitutes."""
    return text.replace("\0", "\u2400").encode("utf-8", "replace").decode("utf-8")
