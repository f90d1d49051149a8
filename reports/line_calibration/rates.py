"""False subharmonics on records that have none."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from reports.line_calibration.kinds import Kind
from reports.line_calibration.records import WINDOW, Record
from tethertest.records.lines import ChannelLines, LineVerdict
from tethertest.spectra import find_lines, fit_drive
from tethertest.spectra.crank_angle import crank_angle
from tethertest.spectra.lines import SIGNIFICANCE

#: chance that a count below the stated rate passes the limit all the same
LIMIT_CHANCE: Final = 0.001
#: the nominal frequency a person would give is off by this share
NOMINAL_ERROR: Final = 1.01
HALF: Final = "1/2"


@dataclass(frozen=True, slots=True)
class Rates:
    """What became of the records of one kind."""

    kind: Kind
    records: int
    false: int  #: with a subharmonic called at any order
    quiet: int  #: without a word on any order p/q
    undetermined: int  #: with any order p/q undetermined
    halves: Mapping[LineVerdict, int]  #: verdicts at order 1/2

    @property
    def limit(self) -> int:
        """False subharmonics that a true rate of 1 % stays at or below, 999 times in 1000."""
        return most_at(SIGNIFICANCE, self.records)

    @property
    def wrong(self) -> int:
        """Records whose verdict at order 1/2 is not among the right ones."""
        right = self.kind.right
        return 0 if right is None else sum(n for verdict, n in self.halves.items() if verdict not in right)

    @property
    def met(self) -> bool:
        """The demands on this kind."""
        enough = self.kind.quiet is None or self.records - self.quiet <= most_at(
            1.0 - self.kind.quiet, self.records
        )
        few = self.false <= self.limit and self.wrong <= self.limit
        return self.kind.beyond or (few and enough)


def most_at(rate: float, records: int) -> int:
    """Return the count that a true rate exceeds with a chance of `LIMIT_CHANCE` only."""
    from scipy.stats import binom

    return int(binom.ppf(1.0 - LIMIT_CHANCE, records, rate))


def analysed(record: Record) -> ChannelLines:
    """Return a record's lines, by the steps of any analysis: drive, crank angle, lines."""
    nominal = NOMINAL_ERROR * record.drive
    drive = fit_drive([record.motion or record.tension], WINDOW, nominal)
    if record.motion is None:
        return find_lines(record.tension, WINDOW, drive, record.expectation)
    crank = crank_angle(record.motion, WINDOW, drive)
    return find_lines(record.tension, WINDOW, drive, record.expectation, crank=crank)


def rates(kind: Kind, records: int, seed: int = 1) -> Rates:
    """Return what became of so many records of one kind."""
    random = np.random.default_rng(seed)
    false = quiet = undetermined = 0
    halves: Counter[LineVerdict] = Counter()
    for _ in range(records):
        lines = analysed(kind.make(random))
        verdicts = {line.order: line.verdict for line in lines.lines if "/" in line.order}
        said = set(verdicts.values())
        false += LineVerdict.SUBHARMONIC in said
        quiet += said == {LineVerdict.NONE}
        undetermined += LineVerdict.UNDETERMINED in said
        halves[verdicts[HALF]] += 1
    return Rates(kind, records, false, quiet, undetermined, halves)
