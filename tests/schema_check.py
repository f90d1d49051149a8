"""Hold a JSON value against a JSON Schema: the words that the published schemas use, and no others."""

from __future__ import annotations

from typing import Any

_TYPES: dict[str, type | tuple[type, ...]] = {
    "object": dict,
    "array": list,
    "string": str,
    "boolean": bool,
    "integer": int,
    "number": (int, float),
    "null": type(None),
}
_KNOWN = {
    "$schema", "$defs", "$ref", "title", "description", "examples", "format", "type", "anyOf", "enum",
    "const", "properties", "required", "additionalProperties", "items", "prefixItems", "minItems", "maxItems",
    "propertyNames",
}  # fmt: skip


def faults(value: Any, schema: dict[str, Any], root: dict[str, Any] | None = None, at: str = "") -> list[str]:
    """Return what is wrong with a value, each fault with its place."""
    root = schema if root is None else root
    assert schema.keys() <= _KNOWN, schema.keys() - _KNOWN
    if "$ref" in schema:
        return faults(value, root["$defs"][schema["$ref"].removeprefix("#/$defs/")], root, at)
    if "anyOf" in schema:
        tried = [faults(value, choice, root, at) for choice in schema["anyOf"]]
        return min(tried, key=len)
    if "const" in schema and value != schema["const"]:
        return [f"{at}: {value!r} is not {schema['const']!r}"]
    if "enum" in schema and value not in schema["enum"]:
        return [f"{at}: {value!r} is none of {schema['enum']}"]
    kind = schema.get("type")
    is_bool_for_number = isinstance(value, bool) and kind != "boolean"
    if kind is not None and (not isinstance(value, _TYPES[kind]) or is_bool_for_number):
        return [f"{at}: {value!r} is no {kind}"]
    if isinstance(value, dict):
        return _faults_of_object(value, schema, root, at)
    return _faults_of_array(value, schema, root, at) if isinstance(value, list) else []


def _faults_of_object(
    value: dict[str, Any], schema: dict[str, Any], root: dict[str, Any], at: str
) -> list[str]:
    properties, others = schema.get("properties", {}), schema.get("additionalProperties", True)
    found = [f"{at}.{key} is missing" for key in schema.get("required", ()) if key not in value]
    for key, item in value.items():
        found += faults(key, schema.get("propertyNames", {}), root, f"the key {at}.{key}")
        if key in properties:
            found += faults(item, properties[key], root, f"{at}.{key}")
        elif others is False:
            found.append(f"{at}.{key} is not in the schema")
        elif others is not True:
            found += faults(item, others, root, f"{at}.{key}")
    return found


def _faults_of_array(value: list[Any], schema: dict[str, Any], root: dict[str, Any], at: str) -> list[str]:
    if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
        return [f"{at}: {len(value)} items"]
    places = schema.get("prefixItems") or [schema.get("items", {})] * len(value)
    return [
        fault
        for number, (item, place) in enumerate(zip(value, places, strict=False))
        for fault in faults(item, place, root, f"{at}[{number}]")
    ]
