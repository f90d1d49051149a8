"""The check that the tests of published JSON rest on sees what is wrong."""

import pytest

from tests.schema_check import faults

SCHEMA = {
    "$defs": {"Line": {"type": "object", "properties": {"n": {"type": "integer"}}, "required": ["n"],
                       "additionalProperties": False}},
    "type": "object",
    "properties": {
        "lines": {"type": "array", "items": {"$ref": "#/$defs/Line"}},
        "span": {"anyOf": [{"type": "array", "prefixItems": [{"type": "number"}, {"type": "number"}],
                            "minItems": 2, "maxItems": 2}, {"type": "null"}]},
        "kind": {"enum": ["a", "b"]},
    },
    "required": ["lines"],
}  # fmt: skip


def test_what_keeps_to_the_schema_has_no_fault():
    assert faults({"lines": [{"n": 1}], "span": [0.5, 2], "kind": "a"}, SCHEMA) == []
    assert faults({"lines": [], "span": None}, SCHEMA) == []


@pytest.mark.parametrize(
    ("value", "fault"),
    [
        ({}, ".lines is missing"),
        ({"lines": [{"n": 1.5}]}, ".lines[0].n: 1.5 is no integer"),
        ({"lines": [{"n": True}]}, ".lines[0].n: True is no integer"),
        ({"lines": [{"n": 1, "m": 2}]}, ".lines[0].m is not in the schema"),
        ({"lines": [], "span": [1.0]}, ".span: 1 items"),
        ({"lines": [], "span": [1.0, None]}, ".span[1]: None is no number"),
        ({"lines": [], "kind": "c"}, ".kind: 'c' is none of ['a', 'b']"),
    ],
)
def test_what_does_not_is_told_with_its_place(value, fault):
    assert faults(value, SCHEMA) == [fault]
