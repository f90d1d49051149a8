"""What a key of a file or of a command's JSON means, said once, in the annotation of its field."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler


def described(schema: dict[str, Any], *texts: str) -> dict[str, Any]:
    """Return a JSON schema with texts before the description that it has."""
    told = "; ".join(text for text in (*texts, schema.get("description", "")) if text)
    return {**schema, "description": told} if told else schema


@dataclass(frozen=True, slots=True)
class Doc:
    """Annotation ``Annotated[float, Doc("largest tension [N]")]``: the description in the JSON schema."""

    text: str
    null: str | None = None  #: what null means, for a field that holds "" or NaN where there is nothing

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        """Let pydantic write null for a text or a number that is not there."""
        schema = handler(source)
        if self.null is None:
            return schema
        from pydantic_core import core_schema

        written = core_schema.plain_serializer_function_ser_schema(
            _or_none, return_schema=core_schema.nullable_schema(handler(source))
        )
        return {**schema, "serialization": written}

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Describe the field."""
        return described(handler(schema), self.text, f"null: {self.null}" if self.null else "")


class _NotInFiles:
    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Leave the field out of the schema."""
        from pydantic_core import PydanticOmit

        raise PydanticOmit


#: annotation of a field that no file has: the program fills it
NOT_IN_FILES = _NotInFiles()

#: a number that may be NaN or infinite
MaybeNumber = Annotated[float, Doc("", null="")]


def _or_none(value: Any) -> Any:
    """Return None for a text that is empty and for what is no finite number."""
    is_there = math.isfinite(value) if isinstance(value, float) else value != ""
    return value if is_there else None
