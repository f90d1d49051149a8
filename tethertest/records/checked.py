"""Types of fields, told where a record is made: a script's slip is named before anything is computed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from numbers import Real
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from tethertest.errors import DataError
from tethertest.records.quantity import SI


def check_types(record: Any) -> None:
    """Refuse a record whose fields do not hold what their annotations say; call it in ``__post_init__``.

    Parameters
    ----------
    record : dataclass instance
        Its fields may be numbers, texts of a `Literal`, tuples, records, or None.

    Raises
    ------
    DataError
        A field holds another type: text in the place of a number, or a quantity with its unit.
    """
    kind: Any = type(record)
    for name, alternatives in _alternatives(kind).items():
        value = getattr(record, name)
        if not any(_fits(value, hint) for hint in alternatives):
            expected = " or ".join(dict.fromkeys(_words(hint) for hint in alternatives))
            message = f"{kind.__name__}({name}=...): found {value!r}, expected {expected}"
            raise DataError(message, _remedy(value, name, alternatives))


@cache
def _alternatives(kind: Any) -> dict[str, tuple[Any, ...]]:
    hints = get_type_hints(kind, include_extras=True)
    return {field.name: tuple(_parts(hints[field.name])) for field in fields(kind)}


def _parts(hint: Any) -> Iterator[Any]:
    inner = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    if get_origin(inner) in {Union, UnionType}:
        for part in get_args(inner):
            yield from _parts(part)
    else:
        yield hint


def _unit(hint: Any) -> str | None:
    """Return the SI unit of a number, if the annotation says one."""
    return next((part.unit for part in get_args(hint)[1:] if isinstance(part, SI)), None)


def _fits(value: Any, hint: Any) -> bool:
    origin = get_origin(hint)
    if origin is Annotated:
        return _fits(value, get_args(hint)[0])
    if origin is Literal:
        return isinstance(value, str) and value in get_args(hint)
    if origin is tuple:
        items = get_args(hint)
        if not isinstance(value, tuple | list):
            return False
        if items[-1] is Ellipsis:
            return all(any(_fits(item, part) for part in _parts(items[0])) for item in value)
        return len(value) == len(items) and all(map(_fits, value, items))
    if hint is float:
        return isinstance(value, Real) and not isinstance(value, bool)
    if hint is NoneType:
        return value is None
    return isinstance(value, hint) if isinstance(hint, type) else True


def _words(hint: Any) -> str:
    origin = get_origin(hint)
    if origin is Annotated:
        unit = _unit(hint)
        return _words(get_args(hint)[0]) + ("" if unit in {None, "1"} else f" in {unit}")
    if origin is Literal:
        return " or ".join(map(repr, get_args(hint)))
    if origin is tuple:
        return f"a tuple, each {_words(get_args(hint)[0])}"
    if hint is float:
        return "a number"
    if hint is NoneType:
        return "None"
    if hint is str:
        return "a text"
    return f"a {hint.__name__}" if is_dataclass(hint) and isinstance(hint, type) else str(hint)


def _remedy(value: Any, name: str, alternatives: tuple[Any, ...]) -> str:
    unit = next((unit for hint in alternatives if (unit := _unit(hint)) is not None), None)
    if isinstance(value, str) and unit is not None:
        return f"give {name} as a number in {unit}; texts with units belong into a file for load_scene"
    if hasattr(value, "to_base_units"):
        return f"give its magnitude: {name}=quantity.to({unit!r}).magnitude"
    return f"correct {name}"
