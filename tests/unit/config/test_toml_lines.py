"""The line of a key, in every way TOML has to write one."""

import tomllib

import pytest

from tethertest.readers.config.toml import read_document

TEXT = '''\
# a comment with = and [brackets]
plain = 1
"quoted key" = "a # no comment" # comment
dotted.inner = [1,
  2, # two
  [3, "]"],
]
literal = 'C:\\'
many = """
not_a_key = 1
[not_a_table]
"""
inline = { one = 1, two = { three = 'x}' }, four = [ { five = 5 } ] }
stamp = 2026-09-05 14:20:00
zoned = 2026-09-05T14:20:00+08:00

[table]
key = true
[table.sub]
key = false

[[entry]]
name = "first"
[entry.sub]
deep = 1
[[entry]]
name = "second"
[[entry.part]]
size = 1
[[entry.part]]
size = 2
'''

LINES = {
    ("plain",): 2,
    ("quoted key",): 3,
    ("dotted", "inner"): 4,
    ("dotted", "inner", 1): 5,
    ("dotted", "inner", 2, 1): 6,
    ("literal",): 8,
    ("many",): 9,
    ("inline",): 13,
    ("inline", "two", "three"): 13,
    ("inline", "four", 0, "five"): 13,
    ("stamp",): 14,
    ("zoned",): 15,
    ("table",): 17,
    ("table", "key"): 18,
    ("table", "sub", "key"): 20,
    ("entry", 0, "name"): 23,
    ("entry", 0, "sub", "deep"): 25,
    ("entry", 1): 26,
    ("entry", 1, "name"): 27,
    ("entry", 1, "part", 0, "size"): 29,
    ("entry", 1, "part", 1, "size"): 31,
}


@pytest.fixture
def document(tmp_path):
    path = tmp_path / "file.toml"
    path.write_text(TEXT, encoding="utf-8")
    return read_document(path, "file")


@pytest.mark.parametrize(("key", "line"), LINES.items(), ids=str)
def test_line_of_a_key(document, key, line):
    assert document.lines[key] == line


def test_every_value_has_a_line_and_every_line_a_value(document):
    def keys(value, here):
        yield here
        pairs = (
            value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
        )
        for part, inner in pairs:
            yield from keys(inner, (*here, part))

    found = {key for key in keys(tomllib.loads(TEXT), ()) if key}
    assert found == document.lines.keys()


def test_a_key_that_is_not_there_has_the_line_of_its_table(document):
    assert document.line_of(("entry", 1, "missing")) == 26
    assert document.line_of(("nowhere",)) is None


def test_windows_line_ends_and_byte_order_mark_are_read(tmp_path):
    path = tmp_path / "file.toml"
    path.write_bytes(b"\xef\xbb\xbfa = 1\r\n\r\nb = '''\r\nx'''\r\nc = 2\r\n")
    assert read_document(path, "file").lines == {("a",): 1, ("b",): 3, ("c",): 5}
