"""TOML text with the line of every key, which `tomllib` alone does not tell."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from tethertest.errors import RunFileError

KeyPath: TypeAlias = tuple[str | int, ...]  #: ("sensor", 3, "rated"); entries of arrays count from 0

#: bytes of a file: a rig of a thousand sensors has half of them
_LARGEST = 2**20
_SPACE = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_BLANK = re.compile(r"[ \t]*")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}(?!")|\'\'\'.*?\'{3,5}(?!\')|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'', re.DOTALL
)
_ATOM = re.compile(r"\d{4}-\d\d-\d\d \d\d:[^\s,\]}#]*|[^\s,\]}#]+")
_SYNTAX_PLACE = re.compile(r"^(?P<what>.*) \(at (?:line (?P<line>\d+), column \d+|end of document)\)$")


@dataclass(frozen=True, slots=True)
class TomlFile:
    """A parsed TOML file."""

    path: Path
    data: dict[str, Any]
    lines: dict[KeyPath, int]  #: line of each key and table, counted from 1

    def line_of(self, key: KeyPath) -> int | None:
        """Return the line of a key, or of the nearest table around it."""
        for end in range(len(key), 0, -1):
            if key[:end] in self.lines:
                return self.lines[key[:end]]
        return None


def read_document(path: Path, what: str) -> TomlFile:
    """Read and parse a TOML file.

    Parameters
    ----------
    path : Path
        The file.
    what : str
        What the file is to a person, e.g. ``"rig file"``.

    Raises
    ------
    RunFileError
        The file is missing, is no UTF-8 text, is not valid TOML, is far too deep or too large.
    """
    try:
        _check_size(path, what)
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        message = f"the {what} does not exist"
        raise RunFileError(message, _nearby(path), path=path) from None
    except UnicodeDecodeError as error:
        message = f"the {what} is not UTF-8 text ({error.reason} at byte {error.start})"
        raise RunFileError(message, "save it as UTF-8", path=path) from None
    except OSError as error:
        message = f"the {what} cannot be read: {error.strerror}"
        raise RunFileError(message, "give the path of a readable TOML file", path=path) from None
    text = text.replace("\r\n", "\n")
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(str(error), text, path) from None
    except (RecursionError, ValueError):
        message = f"the {what} holds a number or a nesting of lists that is too long to read"
        raise RunFileError(message, "write quantities as text with a unit", path=path) from None
    return TomlFile(path, data, _Scanner(text).scan())


def _check_size(path: Path, what: str) -> None:
    if path.exists() and not (path.is_file() or path.is_dir()):
        message = f"the {what} is a pipe or a device"
        raise RunFileError(message, "give the path of a readable TOML file", path=path)
    size = path.stat().st_size
    if size > _LARGEST:
        message = f"the {what} has {size} bytes, expected at most {_LARGEST}"
        raise RunFileError(message, "leave logs and comments of that size in files of their own", path=path)


def _nearby(path: Path) -> str:
    folder = path.parent
    if not folder.is_dir():
        return f"correct the path: the folder {folder} does not exist either"
    found = sorted(entry.name for entry in folder.glob("*.toml"))
    if not found:
        return f"correct the path: there is no .toml file in {folder}"
    return f"correct the path; {folder} has {', '.join(found)}"


def _syntax_error(message: str, text: str, path: Path) -> RunFileError:
    match = _SYNTAX_PLACE.match(message)
    what = match["what"] if match else message
    line = int(match["line"]) if match and match["line"] else text.rstrip().count("\n") + 1
    written = text.splitlines()[line - 1].strip() if text.strip() else ""
    remedy = 'write `key = "value with unit"`, text in double quotes, tables as [name]'
    return RunFileError(f"not valid TOML: {what}, found {written!r}", remedy, path=path, line=line)


class _Scanner:
    """Walks text that `tomllib` has accepted and notes where keys stand; it need not check anything."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0
        self.line, self.counted = 1, 0  # the line at a place: it only moves on
        self.lines: dict[KeyPath, int] = {}
        self.entries: dict[KeyPath, int] = {}  # array of tables -> entries seen

    def scan(self) -> dict[KeyPath, int]:
        table: KeyPath = ()
        self._skip(_SPACE)
        while self.position < len(self.text):
            if self.text.startswith("[", self.position):
                table = self._header()
            else:
                self._pair(table)
            self._skip(_SPACE)
        return self.lines

    def _header(self) -> KeyPath:
        is_array = self.text.startswith("[[", self.position)
        self.position += 2 if is_array else 1
        line = self._line()
        *parents, last = self._key()
        self.position += 2 if is_array else 1
        table: KeyPath = ()
        for part in parents:
            table = self._entered((*table, part))
        table = (*table, last)
        self.lines.setdefault(table, line)
        if is_array:
            self.entries[table] = self.entries.get(table, 0) + 1
            table = self._entered(table)
            self.lines[table] = line
            return table
        return self._entered(table)

    def _entered(self, table: KeyPath) -> KeyPath:
        return (*table, self.entries[table] - 1) if table in self.entries else table

    def _pair(self, table: KeyPath) -> None:
        line = self._line()
        path = table
        for part in self._key():
            path = (*path, part)
            self.lines.setdefault(path, line)
        self.position += 1  # the equals sign
        self._value(path)

    def _key(self) -> list[str]:
        parts = []
        while True:
            self._skip(_BLANK)
            bare = _BARE_KEY.match(self.text, self.position)
            if bare:
                parts.append(bare[0])
                self.position = bare.end()
            else:
                quoted = self._skip(_STRING)
                parts.append(next(iter(tomllib.loads(f"{quoted} = 0"))))
            self._skip(_BLANK)
            if not self.text.startswith(".", self.position):
                return parts
            self.position += 1

    def _value(self, path: KeyPath) -> None:
        self._skip(_BLANK)
        first = self.text[self.position]
        if first not in "[{":
            self._skip(_STRING if first in "\"'" else _ATOM)
            return
        self.position += 1
        entry = 0
        while True:
            self._skip(_SPACE)
            if self.text[self.position] in "]}":
                self.position += 1
                return
            if self.text[self.position] == ",":
                self.position += 1
            elif first == "{":
                self._pair(path)
            else:
                self.lines[*path, entry] = self._line()
                self._value((*path, entry))
                entry += 1

    def _line(self) -> int:
        self.line += self.text.count("\n", self.counted, self.position)
        self.counted = self.position
        return self.line

    def _skip(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self.text, self.position)
        if match is None:  # pragma: no cover - tomllib has accepted the text
            message = f"no {pattern.pattern!r} at {self.position}"
            raise AssertionError(message)
        self.position = match.end()
        return match[0]
