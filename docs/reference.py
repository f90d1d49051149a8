"""Reference pages of run, rig, prototype and scene files, made of their schemas.

``python docs/reference.py`` writes them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tethertest.cli.schemas import FILES, schema_of

FOLDER = Path(__file__).with_name("reference")


def page(kind: str) -> str:
    """Return the Markdown of one kind of file: a table of keys for each table of the TOML."""
    schema = schema_of(kind)
    lines = [f"# Keys of a {kind} file", "", schema["description"], ""]
    lines += [f"`tethertest schema {kind}` prints the same as JSON Schema, for editors.", ""]
    for heading, table in _tables(schema, schema, ""):
        lines += [f"## {heading}", ""] if heading else []
        if heading and table.get("description"):
            lines += [table["description"], ""]
        lines += ["| key | must be there | what it is |", "|---|---|---|"]
        required = table.get("required", [])
        for key, said in table["properties"].items():
            need = "yes" if key in required else _default(said)
            lines.append(f"| `{key}` | {need} | {_meaning(said, schema)} |")
        lines.append("")
    return "\n".join(lines)


def _tables(table: dict[str, Any], schema: dict[str, Any], path: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the heading and the schema of every table of the file, outermost first."""
    yield path, table
    for key, said in table["properties"].items():
        inner, brackets = _inner(said, schema)
        if inner is None:
            continue
        name = f"{path.strip('[]')}.{key}" if path else key
        yield from _tables(inner, schema, brackets.replace("NAME", name))


def _inner(said: dict[str, Any], schema: dict[str, Any]) -> tuple[dict[str, Any] | None, str]:
    """Return the schema of the table that a key holds, and how TOML writes its heading."""
    for found, brackets in (
        (said, "[NAME]"),
        (said.get("items", {}), "[[NAME]]"),
        (said.get("additionalProperties", {}), "[NAME.name]"),
    ):
        if isinstance(found, dict) and "$ref" in found:
            inner = schema["$defs"][found["$ref"].rsplit("/", 1)[1]]
            if "properties" in inner:
                return inner, brackets
    return None, ""


def _default(said: dict[str, Any]) -> str:
    value = said.get("default")
    return "no" if value is None or isinstance(value, dict | list) else f"no, else `{value}`"


def _meaning(said: dict[str, Any], schema: dict[str, Any]) -> str:
    words = said.get("description", "")
    inner, _ = _inner(said, schema)
    if inner is not None and not words:
        words = inner.get("description", "")
    choices = [f"`{choice}`" for part in (said, *said.get("anyOf", [])) for choice in part.get("enum", [])]
    listed = f"; one of {', '.join(choices)}" if choices else ""
    table = " (below)" if inner is not None else ""
    return f"{words}{listed}{table}".replace("|", "\\|").replace("\n", " ").lstrip("; ")


def main() -> None:
    """Write all pages."""
    FOLDER.mkdir(exist_ok=True)
    for kind in FILES:
        (FOLDER / f"{kind}.md").write_text(page(kind), encoding="utf-8")


if __name__ == "__main__":
    main()
