"""JSON Schema 2020-12 of the TOML files, made from the records: editors complete and check with it."""

from __future__ import annotations

import ast
import inspect
import tokenize
from dataclasses import is_dataclass
from functools import cache
from io import StringIO
from typing import Any, Literal, TypeAlias, get_args

from tethertest.readers.config.structure import DERIVED_FIELDS, field_types
from tethertest.records.rig import Prototype, Rig
from tethertest.records.run import RunFile
from tethertest.records.scene import Scene

FileKind: TypeAlias = Literal["run", "rig", "prototype", "scene"]

DIALECT = "https://json-schema.org/draft/2020-12/schema"
FILE_RECORDS: dict[FileKind, type] = {"run": RunFile, "rig": Rig, "prototype": Prototype, "scene": Scene}


def json_schema(kind: FileKind) -> dict[str, Any]:
    """Return the JSON Schema of one kind of file.

    Parameters
    ----------
    kind : {"run", "rig", "prototype", "scene"}
        Kind of file.

    Returns
    -------
    dict
        JSON Schema 2020-12; descriptions come from the records' docstrings and field comments. Unknown keys
        are not allowed anywhere.
    """
    from pydantic import TypeAdapter

    record = FILE_RECORDS[kind]
    schema = TypeAdapter(record).json_schema()
    known = {table.__name__ for table in _tables(record)}
    tables = {name: table for name, table in schema.pop("$defs", {}).items() if name in known}
    for table in _tables(record):
        _finish(schema if table is record else tables[table.__name__], table)
    finished: dict[str, Any] = _without_null({"$schema": DIALECT, **schema, "$defs": tables})
    finished["title"] = f"tethertest {kind} file"
    return finished


def _tables(record: type) -> list[type]:
    """Return the dataclasses that a file's record is made of, itself first."""
    found: list[type] = []
    waiting: list[Any] = [record]
    while waiting:
        kind = waiting.pop(0)
        if is_dataclass(kind) and isinstance(kind, type):
            if kind not in found:
                found.append(kind)
                waiting += field_types(kind).values()
        else:
            waiting += get_args(kind)
    return found


def _finish(schema: dict[str, Any], table: type) -> None:
    schema["additionalProperties"] = False
    schema["description"] = inspect.getdoc(table) or ""
    comments = field_comments(table)
    for name in DERIVED_FIELDS & schema["properties"].keys():
        del schema["properties"][name]
    for name, described in schema["properties"].items():
        described.pop("title", None)
        texts = [text for text in (comments.get(name), described.get("description")) if text]
        if texts:
            described["description"] = "; ".join(texts)


def _without_null(schema: Any) -> Any:
    """Return a schema without the null that TOML does not have."""
    if isinstance(schema, list):
        return [_without_null(entry) for entry in schema]
    if not isinstance(schema, dict):
        return schema
    kept = {key: _without_null(value) for key, value in schema.items() if value is not None}
    choices = kept.get("anyOf")
    if choices is None:
        return kept
    kept["anyOf"] = [choice for choice in choices if choice != {"type": "null"}]
    if len(kept["anyOf"]) > 1:
        return kept
    (only,) = kept.pop("anyOf")
    texts = [text for text in (kept.pop("description", None), only.get("description")) if text]
    return {**only, **kept, **({"description": "; ".join(texts)} if texts else {})}


@cache
def field_comments(table: type) -> dict[str, str]:
    """Return the ``#:`` comment of every field of a dataclass that has one, from its source."""
    source = inspect.getsource(table)
    comments = {
        token.start[0]: token.string[2:].strip()
        for token in tokenize.generate_tokens(StringIO(source).readline)
        if token.type == tokenize.COMMENT and token.string.startswith("#:")
    }
    (definition,) = ast.parse(source).body
    found = {}
    for node in definition.body if isinstance(definition, ast.ClassDef) else []:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            lines = range(node.lineno, (node.end_lineno or node.lineno) + 1)
            texts = [comments[line] for line in lines if line in comments]
            if texts:
                found[node.target.id] = " ".join(texts)
    return found
