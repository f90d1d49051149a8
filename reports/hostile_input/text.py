"""Text and JSON logs of odd sizes, signs and numbers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from reports.hostile_input.case import GOOD, SECRET, Case

HEAD: Final = "time [s],F [N]\n"
ROWS: Final = "0.0,1.5\n0.5,2.5\n1.0,3.5\n1.5,4.5\n"


def text(content: str, encoding: str = "utf-8") -> Callable[[Path], object]:
    return lambda path: path.write_bytes(content.encode(encoding))


def repeated(head: bytes, block: bytes, count: int, tail: bytes = b"") -> Callable[[Path], None]:
    """Return what writes a large file in pieces."""

    def make(path: Path) -> None:
        with path.open("wb") as file:
            file.write(head)
            for _ in range(count):
                file.write(block)
            file.write(tail)

    return make


def wide(columns: int, rows: int) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        with path.open("w", encoding="ascii") as file:
            file.write("time [s]," + ",".join(f"F{number}" for number in range(1, columns)) + "\n")
            for row in range(rows):
                file.write(f"{0.5 * row}" + ",1" * (columns - 1) + "\n")

    return make


def named(*names: str) -> str:
    """Return a sound log whose columns have these names."""
    lines = ["time [s]," + ",".join('"' + name.replace('"', '""') + '"' for name in names)]
    lines += [
        f"{0.5 * row},{','.join(str(1.5 + row + place) for place, _ in enumerate(names))}" for row in range(4)
    ]
    return "\n".join(lines) + "\n"


def with_unit(unit: str) -> str:
    return f"time [s],F [{unit}]\n{ROWS}"


def _text(name: str, attack: str, make: Callable[[Path], object], said: str, **keys: Any) -> Case:
    return Case("text", name, attack, "log.csv", make, said, never=str(SECRET)[:6], **keys)


def _json(name: str, attack: str, make: Callable[[Path], object], said: str, **keys: Any) -> Case:
    return Case("JSON", name, attack, "log.json", make, said, **keys)


CASES: Final = (
    _text("10^6 columns", "memory", wide(10**6, 3), "a line or blank lines of more than 1 MB"),
    _text("100,000 columns", "memory", wide(100_000, 3), "found 100000 columns, expected at most 20000"),
    _text(
        "10^6 columns without names",
        "memory",
        repeated(b"0", b",1" * 1000, 1000, b"\n1" + b",1" * 10**6 + b"\n"),
        "a line or blank lines of more than 1 MB",
    ),
    _text(
        "300,000 columns between blanks",
        "memory",
        text(("0" + " 1" * 300_000 + "\n") * 20),
        "found 300001 columns",
    ),
    _text(
        "a line of 200 MB",
        "memory",
        repeated(HEAD.encode(), b"1" * 10**6, 200),
        "a line or blank lines of more than 1 MB",
        slow=True,
    ),
    _text(
        "200 MB of separators",
        "memory",
        repeated(HEAD.encode(), b"," * 10**6, 200),
        "a line or blank lines of more than 1 MB",
        slow=True,
    ),
    _text(
        "a line of 200 MB after sound rows",
        "memory",
        repeated(GOOD.encode(), b"1" * 10**6, 200),
        "a line or blank lines of more than 1 MB",
        slow=True,
    ),
    _text(
        "200 MB of line ends",
        "time",
        repeated(HEAD.encode(), b"\n" * 10**6, 200, ROWS.encode()),
        "a line or blank lines of more than 1 MB",
        slow=True,
    ),
    _text("10^7 rows of two digits", "time", repeated(b"a,b\n", b"1,2\n" * 10**4, 1000), "time", slow=True),
    _text(
        "10^7 lines of one digit",
        "time",
        repeated(b"a\n", b"1\n" * 10**4, 1000),
        "no rows of numbers",
        slow=True,
    ),
    _text(
        "a quote that is never closed",
        "memory",
        repeated(HEAD.encode() + ROWS.encode() * 200 + b'2.0,"', b"1.5,1.5\n" * 10**4, 500),
        "quote|found",
        slow=True,
    ),
    _text("10^6 quotes in a line", "time", text(HEAD + ROWS + "2.0," + '"' * 10**6 + "\n"), "found|quote"),
    _text(
        "a number of 10^5 digits",
        "time",
        text(HEAD + ROWS + "2.0," + "9" * 10**5 + "\n2.5,1\n"),
        '"missing": 1',
        refused=False,
    ),
    _text(
        "a fraction of 10^5 digits",
        "time",
        text(HEAD + ROWS + "2.0,1." + "9" * 10**5 + "\n2.5,1\n"),
        '"maximum": 4.5',
        refused=False,
    ),
    _text(
        "a time of 10^5 digits",
        "time",
        text(HEAD + ROWS + "9" * 10**5 + ",1\n" + "9" * 10**5 + "1,1\n"),
        "time",
    ),
    _text(
        "1e400, -1e400, 1e-400",
        "faults",
        text(HEAD + ROWS + "2.0,1e400\n2.5,-1e400\n3.0,1e-400\n3.5,1\n"),
        '"missing": 2',
        refused=False,
    ),
    _text("nan, inf and 1e999999999 as times", "faults", text(HEAD + ROWS + "nan,1\n"), "time|blank|found"),
    _text("NUL bytes", "cuts texts", text(HEAD + ROWS + "2.0,\0\0\n"), "NUL bytes"),
    _text(
        "NUL bytes after 3 MB",
        "cuts texts",
        repeated(HEAD.encode(), b"1.0,1.0\n" * 10**5, 4, b"2.0,\0\n"),
        "NUL bytes",
    ),
    _text("=1+1 in a cell", "is a formula", text(HEAD + ROWS + "2.0,=1+1\n2.5,1\n"), "found '=1\\+1'"),
    _text("@SUM(A1) in a cell", "is a formula", text(HEAD + ROWS + "2.0,@SUM(A1)\n2.5,1\n"), "found '@SUM"),
    _text(
        "+cmd|... in a cell",
        "runs a program",
        text(HEAD + ROWS + "2.0,+cmd|'/C calc'!A0\n2.5,1\n"),
        "found .*\\+cmd",
    ),
    _text(
        "__import__('os') in a cell",
        "is evaluated",
        text(HEAD + ROWS + "2.0,__import__('os').abort()\n2.5,1\n"),
        "found .*__import__",
    ),
    _text(
        "formulas as names",
        "is a formula",
        text(named("=1+1", "@SUM(A1)", "+cmd|' /C calc'!A0", "-2+3")),
        '"name": "=1\\+1"',
        refused=False,
    ),
    _text(
        "odd names",
        "the terminal",
        text(
            named(
                "\x1b[2J\x1b[31mred",
                "a/../../b",
                "..",
                "n" * 5000,
                "\u202egnp.exe",
                "[/bold]",
                "{0.__class__}",
                "%s%n",
            )
        ),
        r'"name": "\\u001b\[2J',
        refused=False,
    ),
    _text(
        "a unit 9**9**9**9",
        "time",
        text(with_unit("9**9**9**9")),
        "unit '9.*(cannot be read|not known)",
        refused=False,
        slow=True,
    ),
    _text(
        "a unit of 10^5 letters", "time", text(with_unit("N" * 10**5)), "not known", refused=False, slow=True
    ),
    _text(
        "a unit __import__('os')",
        "is evaluated",
        text(with_unit("__import__('os').abort()")),
        "cannot be read|not known",
        refused=False,
    ),
    _text(
        "60,000 comment lines",
        "time",
        repeated(b"", b"# no\n" * 1000, 60, GOOD.encode()),
        "no rows of numbers",
    ),
    _text(
        "UTF-16 with half a character",
        "faults",
        lambda path: path.write_bytes(GOOD.encode("utf-16") + b"\xd8"),
        "does not belong to the encoding|cut|NUL",
    ),
    _text(
        "bytes of no encoding", "faults", lambda path: path.write_bytes(bytes(range(1, 256)) * 1000), "found"
    ),
    _json("100,000 brackets", "the stack", text("[" * 10**5), "nested too deep|no rows"),
    _json(
        "100,000 objects in each other",
        "the stack",
        text('{"a":' * 10**5 + "1" + "}" * 10**5),
        "nested too deep",
    ),
    _json(
        "1,000 lists in each other",
        "the stack",
        text('{"t": [0, 1, 2], "F": ' + "[" * 900 + "]" * 900 + "}"),
        "no channels",
    ),
    _json(
        "1e400, NaN and Infinity",
        "faults",
        text('{"t [s]": [0, 1, 2, 3], "F": [1e400, NaN, -Infinity, 4]}'),
        '"missing": 3',
        refused=False,
    ),
    _json(
        "a number of 10^5 digits",
        "time",
        text('{"t [s]": [0, 1, 2], "F": [1, 2, ' + "9" * 10**5 + "]}"),
        '"missing": 1',
        refused=False,
    ),
    _json(
        "a key twice",
        "shows another one",
        text('{"t": [0, 1, 2], "F": [1, 2, 3], "F": [4, 5, 6]}'),
        "stands twice",
    ),
    _json(
        "__proto__ and __class__",
        "changes objects",
        text('{"t [s]": [0, 1, 2], "__class__": [1, 2, 3], "__proto__": [1, 2, 3]}'),
        '"name": "__class__"',
        refused=False,
    ),
    _json(
        "10^6 keys",
        "time",
        text("{" + ",".join(f'"{key}":[1,2]' for key in range(10**6)) + "}"),
        "has 1000000 keys",
        slow=True,
    ),
    _json(
        "10^6 objects",
        "time",
        text("{" + ",".join(f'"{key}":{{}}' for key in range(10**6)) + "}"),
        "has 1000000 keys",
        slow=True,
    ),
    _json(
        "half a surrogate pair",
        "faults",
        text('{"t [s]": [0, 1, 2], "F\\ud800": [1, 2, 3]}'),
        "half of a pair",
    ),
    _json(
        "40 MB of empty lists",
        "memory",
        repeated(b"[", b"[]," * 10**5, 130, b"[]]"),
        "has 13000002 lists",
        slow=True,
    ),
    _json("rows of no values", "faults", text("[[],[],[]]"), "holds rows of no values"),
)
