"""What a command's exit code says."""

from __future__ import annotations

from typing import Final

PASSED: Final = 0
FAILED: Final = 1
BAD_INPUT: Final = 2
PROGRAM_FAULT: Final = 3
UNDECIDED: Final = 4
INTERRUPTED: Final = 130  #: as a shell's own commands
