"""One hostile input: how it is made, what is asked of it, and what must come of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

#: a sound log of two rows and more, of which many cases are made
GOOD: Final = "time [s],F_top [N]\n0.0,1.5\n0.5,2.5\n1.0,3.5\n1.5,4.5\n"
#: a number that stands in files beside the log alone: it must never be said
SECRET: Final = 424242.125
INSPECT: Final = ("inspect", "{}", "--json")


@dataclass(frozen=True)
class Case:
    """A file or a run folder that is made to do harm."""

    kind: str  #: of the input: "HDF5", "text", ...
    name: str
    attack: str  #: what it would do to a reader that trusts it
    file: str  #: its name
    make: Callable[[Path], object]  #: makes it at this path, in a folder of its own
    said: str  #: pattern of the refusal, or of what is told of a log that is read right
    refused: bool = True
    command: tuple[str, ...] = INSPECT  #: ``{}`` stands for the file
    never: str = ""  #: pattern of what must not be said nor written
    slow: bool = False  #: takes more than a second or two

    @property
    def title(self) -> str:
        """Kind and name."""
        return f"{self.kind}: {self.name}"
