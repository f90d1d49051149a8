"""Records as JSON and as JSON Schema, by one mechanism: the annotations of their fields."""

from __future__ import annotations

import inspect
import json
import math
from functools import cache
from typing import Any, Literal, cast

from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema

DIALECT = "https://json-schema.org/draft/2020-12/schema"


class _WithDocstrings(GenerateJsonSchema):
    """Schemas whose objects are described by their records' docstrings, which older pydantic leaves out."""

    def dataclass_schema(self, schema: Any) -> dict[str, Any]:
        return {**super().dataclass_schema(schema), "description": inspect.getdoc(schema["cls"]) or ""}


def as_json(record: Any) -> dict[str, Any]:
    """Return a record as JSON values; a number that JSON does not have is None.

    Parameters
    ----------
    record : dataclass
        Its type says what becomes of each field.
    """
    found: dict[str, Any] = _finite(_adapter(cast("Any", type(record))).dump_python(record, mode="json"))
    return found


def json_line(record: Any) -> str:
    """Return a record as the one line of JSON that a command prints."""
    return json.dumps(as_json(record), ensure_ascii=False, allow_nan=False)


def json_text(record: Any, *, indent: int, sort_keys: bool = False) -> str:
    """Return a record as the text of a JSON file; the same record gives the same bytes."""
    found = as_json(record)
    return json.dumps(found, ensure_ascii=False, allow_nan=False, indent=indent, sort_keys=sort_keys) + "\n"


def file_schema(record: type, title: str) -> dict[str, Any]:
    """Return the JSON Schema 2020-12 of the TOML files that a record is made from.

    Unknown keys are not allowed anywhere, and TOML has no null.
    """
    schema = _tidied(_schema(record, "validation"), in_files=True)
    return {"$schema": DIALECT, **schema, "title": title}


def printed_schema(record: Any, title: str, may_lack: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return the JSON Schema 2020-12 of what `as_json` makes of a record, or of one of several.

    Parameters
    ----------
    record : type
        A dataclass, or a union of them.
    title : str
    may_lack : tuple of str
        Keys of the object that are not always there; all others are.
    """
    schema = _tidied(_schema(record, "serialization"), in_files=False)
    if may_lack:
        schema["required"] = [key for key in schema["required"] if key not in may_lack]
    return {"$schema": DIALECT, **schema, "title": title}


def _schema(record: Any, mode: Literal["validation", "serialization"]) -> dict[str, Any]:
    return _adapter(record).json_schema(mode=mode, schema_generator=_WithDocstrings)


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(kind)


def _finite(value: Any) -> Any:
    """Return the same value with every number that JSON cannot hold as None."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


def _tidied(schema: Any, *, in_files: bool) -> Any:
    """Return a schema with closed objects and without pydantic's titles."""
    if isinstance(schema, list):
        return [_tidied(entry, in_files=in_files) for entry in schema]
    if not isinstance(schema, dict):
        return schema
    kept = {
        key: _tidied(value, in_files=in_files)
        for key, value in schema.items()
        if not (key == "title" and isinstance(value, str)) and (in_files or key != "default")
    }
    if isinstance(kept.get("properties"), dict):
        kept["additionalProperties"] = False
        if not in_files:
            kept["required"] = list(kept["properties"])
    return _without_null(kept) if in_files else kept


def _without_null(schema: dict[str, Any]) -> dict[str, Any]:
    if schema.get("default", ...) is None:
        del schema["default"]
    if "anyOf" not in schema:
        return schema
    *others, last = [choice for choice in schema["anyOf"] if choice != {"type": "null"}]
    if others:
        return {**schema, "anyOf": [*others, last]}
    del schema["anyOf"]
    return {**last, **schema}
