"""From TOML tables to frozen records: keys, values and uncertainties, driven by the records' annotations."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from tethertest.readers.config.problems import Problem, dotted, suggestion
from tethertest.readers.config.toml import KeyPath
from tethertest.records.described import NOT_IN_FILES
from tethertest.records.quantity import SI
from tethertest.units import parse_quantity

#: unknown keys of one table that are told; a search for the nearest name takes time
_UNKNOWN = 50

Record = TypeVar("Record")


def structure(kind: type[Record], data: dict[str, Any]) -> tuple[Record | None, list[Problem]]:
    """Turn TOML tables into a record.

    Parameters
    ----------
    kind : type
        A frozen dataclass of `tethertest.records`.
    data : dict
        The file's tables.

    Returns
    -------
    record : Record or None
        None where the values do not allow one. Keys with a wrong value are left out if the record can stand
        without them, so that what remains can still be checked.
    problems : list of Problem
        Unknown keys and wrong or missing values.
    """
    problems = [*_key_problems(kind, data, ())]
    known = {problem.key for problem in problems}
    record, wrong = _validated(kind, data)
    problems += [problem for problem in wrong if problem.key not in known]
    if record is None:
        record, _ = _validated(kind, _without(data, {_owner(problem.key) for problem in problems}))
    return record, problems


def uncertainties(kind: type, data: dict[str, Any]) -> dict[str, float]:
    """Return the standard uncertainties written as ``+/-``, by dotted key, in SI.

    Entries of arrays go by name: ``"sensor.tension_top.sensitivity"``.
    """
    found = {}
    for key, unit, value in _quantities(kind, data, ()):
        if isinstance(value, str):
            uncertainty = parse_quantity(value, unit).uncertainty
            if uncertainty is not None:
                found[dotted(key, data)] = uncertainty
    return found


@cache
def field_types(kind: type) -> dict[str, Any]:
    """Return the annotation of every field that a file may have, units included."""
    hints = get_type_hints(kind, include_extras=True)
    names = [field.name for field in fields(kind)]
    return {name: hints[name] for name in names if NOT_IN_FILES not in get_args(hints[name])}


@cache
def _adapter(kind: Any) -> Any:
    from pydantic import TypeAdapter

    return TypeAdapter(kind)


def _validated(kind: type[Record], data: dict[str, Any]) -> tuple[Record | None, list[Problem]]:
    from pydantic import ValidationError

    adapter = _adapter(cast("Any", kind))
    try:
        return adapter.validate_python(data), []
    except ValidationError as error:
        problems = [_problem(kind, data, entry) for entry in error.errors(include_url=False)]
        return None, [problem for problem in problems if problem is not None]


def _problem(kind: type, data: Any, entry: Any) -> Problem | None:
    """Return one of pydantic's errors in our words; None for the branch of a union that was not meant."""
    key: KeyPath = ()
    value = data
    missing = entry["type"] == "missing"
    for depth, part in enumerate(entry["loc"]):
        if isinstance(value, dict) and (part in value or (missing and depth == len(entry["loc"]) - 1)):
            value = value.get(part)
        elif isinstance(value, list) and isinstance(part, int):
            value = value[part] if part < len(value) else None
        elif str(part).startswith("tuple[") != isinstance(value, list):
            return None
        else:
            continue
        key = (*key, part)
    if missing:
        return Problem(key, *_missing(kind, key))
    if entry["type"] == "quantity":
        return Problem(key, entry["ctx"]["problem"], entry["ctx"]["remedy"])
    if entry["type"] == "literal_error":
        choices = [str(choice) for choice in get_args(_type_at(kind, key))]
        text = f"found {value!r}, expected one of {', '.join(choices)}"
        return Problem(key, text, suggestion(str(value), choices))
    expected = _EXPECTED.get(entry["type"], entry["msg"][0].lower() + entry["msg"][1:])
    found = "a table" if isinstance(value, dict) else repr(value)
    remedy = _REMEDIES.get(entry["type"], "correct the value")
    return Problem(key, f"found {found}, expected {expected}", remedy)


_EXPECTED = {
    "string_type": "text",
    "dataclass_type": "a table",
    "dict_type": "a table",
    "tuple_type": "an array",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "float_parsing": "a number",
    "too_long": "an array of fewer entries",
}
_REMEDIES = {
    "string_type": "put the value in double quotes",
    "dataclass_type": "write the keys below a [table] header",
    "dict_type": "write the keys below a [table] header",
    "tuple_type": "write an array: [a, b] for values, a header in double brackets [[...]] for tables",
}


def _missing(kind: type, key: KeyPath) -> tuple[str, str]:
    expected = _type_at(kind, key)
    unit = _unit(expected)
    name = key[-1]
    if isinstance(name, int):
        return f"entry {name + 1} is missing", "add it"
    if unit is not None:
        example = "0.5" if unit == "1" else f'"1.5 {unit}"'
        return f"is missing, expected a quantity in {unit}", f"add `{name} = {example}`"
    if get_origin(expected) is tuple and is_dataclass(get_args(expected)[0]):
        return "is missing, expected an array of tables", f"add a table below a [[{name}]] header"
    if is_dataclass(expected):
        return "is missing, expected a table", f"add a table below a [{name}] header"
    return "is missing", f'add `{name} = "..."`'


def _key_problems(kind: Any, data: Any, key: KeyPath) -> Iterator[Problem]:
    if kind is dt.date or kind is dt.datetime:
        if not isinstance(data, kind):
            stamp = "2026-09-05T14:20:00+08:00" if kind is dt.datetime else "2026-09-05"
            what = "a date with time and zone" if kind is dt.datetime else "a date"
            yield Problem(key, f"found {str(data)!r}, expected {what}", f"write it without quotes: {stamp}")
    elif is_dataclass(kind) and isinstance(data, dict):
        known = field_types(kind)  # type: ignore[arg-type]
        unknown = [name for name in data if name not in known]
        for name in unknown[:_UNKNOWN]:
            yield Problem((*key, name), "unknown key", suggestion(name, known))
    for inner, value, part in _children(kind, data):
        yield from _key_problems(inner, value, (*key, part))


def _quantities(kind: Any, data: Any, key: KeyPath) -> Iterator[tuple[KeyPath, str, Any]]:
    unit = _unit(kind)
    if unit is not None and not isinstance(data, list):
        yield key, unit, data
    for inner, value, part in _children(kind, data):
        yield from _quantities(inner, value, (*key, part))


def _children(kind: Any, data: Any) -> Iterator[tuple[Any, Any, str | int]]:
    """Yield the annotation, value and key part of everything directly inside a value."""
    kind = _branch(kind, data)
    if is_dataclass(kind) and isinstance(data, dict):
        for name, inner in field_types(kind).items():  # type: ignore[arg-type]
            if name in data:
                yield _branch(inner, data[name]), data[name], name
    elif get_origin(kind) is tuple and isinstance(data, list):
        inners = get_args(kind)
        for part, value in enumerate(data):
            inner = inners[0] if inners[-1] is Ellipsis else inners[min(part, len(inners) - 1)]
            yield _branch(inner, value), value, part
    elif get_origin(kind) in {dict, Mapping} and isinstance(data, dict):
        for name, value in data.items():
            yield _branch(get_args(kind)[1], value), value, name


def _branch(kind: Any, data: Any) -> Any:
    """Return the member of a union that a value is meant for: a tuple for an array, else the other one."""
    if get_origin(kind) is Annotated and _unit(kind) is None:
        kind = get_args(kind)[0]
    if get_origin(kind) not in {Union, UnionType}:
        return kind
    members = [member for member in get_args(kind) if member is not NoneType]
    meant = [member for member in members if (get_origin(member) is tuple) == isinstance(data, list)]
    return _branch((meant or members)[0], data)


def _type_at(kind: Any, key: KeyPath) -> Any:
    for part in key:
        kind = _branch(kind, [] if isinstance(part, int) else None)
        if is_dataclass(kind):
            kind = field_types(kind)[str(part)]  # type: ignore[arg-type]
        elif get_origin(kind) is tuple:
            kind = get_args(kind)[0]
        else:
            kind = get_args(kind)[1]
    return _branch(kind, None)


def _unit(kind: Any) -> str | None:
    if get_origin(kind) in {Union, UnionType}:
        return next((unit for unit in map(_unit, get_args(kind)) if unit is not None), None)
    if get_origin(kind) is not Annotated:
        return None
    return next((extra.unit for extra in get_args(kind)[1:] if isinstance(extra, SI)), None)


def _owner(key: KeyPath) -> KeyPath:
    """Return the key whose value a problem spoils: for an entry of an array, the array."""
    return key[:-1] if isinstance(key[-1], int) else key


def _without(data: Any, keys: set[KeyPath], here: KeyPath = ()) -> Any:
    if isinstance(data, dict):
        return {
            name: _without(value, keys, (*here, name))
            for name, value in data.items()
            if (*here, name) not in keys
        }
    if isinstance(data, list):
        return [_without(value, keys, (*here, part)) for part, value in enumerate(data)]
    return data
