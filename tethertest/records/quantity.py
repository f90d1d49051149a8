"""The unit of a field that comes from a file, said once, in its annotation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tethertest.errors import QuantityError
from tethertest.records.described import described
from tethertest.units import parse_quantity

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler


@dataclass(frozen=True, slots=True)
class SI:
    """Annotation ``Annotated[float, SI("N", "of the lift")]``: text with a unit becomes a number in SI."""

    unit: str  #: SI unit; ``"1"`` for a pure number
    text: str = ""  #: what the key means
    above: float | None = None  #: the value must be greater
    minimum: float | None = None  #: the value must be at least this
    maximum: float | None = None  #: the value must be at most this

    def parse(self, text: object) -> float:
        """Return the value in SI.

        Raises
        ------
        QuantityError
            Unit, dimension or range is wrong.
        """
        value = parse_quantity(text, self.unit).value  # type: ignore[arg-type]
        for bound, wrong, words in (
            (self.above, self.above is not None and value <= self.above, "more than"),
            (self.minimum, self.minimum is not None and value < self.minimum, "at least"),
            (self.maximum, self.maximum is not None and value > self.maximum, "at most"),
        ):
            if wrong:
                unit = "" if self.unit == "1" else f" {self.unit}"
                message = f"found {text!r}, expected {words} {bound:g}{unit}"
                forgotten = self.unit == "1" and words == "at most" and not isinstance(text, str)
                remedy = (
                    f'correct the value; per cent is text: "{text} %"' if forgotten else "correct the value"
                )
                raise QuantityError(message, remedy)
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        """Let pydantic call `parse`; its message carries the problem and the remedy."""
        from pydantic_core import PydanticCustomError, core_schema

        def validate(text: object) -> float:
            try:
                return self.parse(text)
            except QuantityError as error:
                msg = "quantity"
                raise PydanticCustomError(
                    msg,
                    "{problem}\n  fix: {remedy}",
                    {"problem": error.problem, "remedy": error.remedy},
                ) from error

        return core_schema.no_info_plain_validator_function(validate)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Describe the text that files have, and the number that commands print."""
        if handler.mode == "serialization":
            unit = "" if self.unit == "1" else f" [{self.unit}]"
            return described({"type": "number"}, f"{self.text}{unit}")
        limits = [
            f"{words} {bound:g}"
            for words, bound in (
                ("more than", self.above),
                ("at least", self.minimum),
                ("at most", self.maximum),
            )
            if bound is not None
        ]
        quantity = f"quantity in {self.unit}" if self.unit != "1" else "pure number"
        description = "; ".join(text for text in (self.text, ", ".join([quantity, *limits])) if text)
        text = {"type": "string", "pattern": r"^\s*[-+]?(\d|\.\d)"}
        if self.unit == "1":
            return {"anyOf": [{"type": "number"}, text], "description": description}
        return {**text, "description": description, "examples": [f"1.5 {self.unit}"]}
