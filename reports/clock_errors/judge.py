"""What the alignment says of a run, against what it was made with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from reports.clock_errors.bound import Bound
from reports.clock_errors.random_runs import SyntheticRun, random_run
from reports.clock_errors.rig import RIG
from tethertest.conditioning.clocks.fitted import fitted_clock
from tethertest.records.channel import Severity
from tethertest.records.rig import Rig

#: an interval of 95 % reaches this many standard errors
COVERAGE_95 = 1.959964
#: an offset is in another cycle when it is off by more than this share of the drive's period
OTHER_CYCLE = 0.25
#: or by this: after a knock the UAV bounces with a period of 70 ms, and no knock may be taken for another [s]
BOUNCE = 0.03

Outcome = Literal["fitted", "refused", "wrong cycle"]


@dataclass(frozen=True, slots=True)
class Judged:
    """One run's verdict."""

    number: int
    kind: str
    transients: str
    stamps: str
    gaps: int
    length: float  #: [s]
    frequency: float  #: [Hz]
    rates: tuple[float, float]  #: [Hz]
    outcome: Outcome
    reasons: tuple[str, ...]  #: why it was refused
    offset_error: float  #: fitted less true [s]
    offset_stated: float  #: standard error as stated [s]
    drift_error: float
    drift_stated: float
    bound: Bound

    @property
    def offset_covered(self) -> bool:
        """Whether the true offset lies inside the stated 95 % interval."""
        return abs(self.offset_error) <= COVERAGE_95 * self.offset_stated

    @property
    def drift_covered(self) -> bool:
        """Whether the true drift lies inside the stated 95 % interval."""
        return abs(self.drift_error) <= COVERAGE_95 * self.drift_stated

    @property
    def ramped(self) -> bool:
        """Whether both records hold a start or a stop of the drive."""
        return self.transients in ("start and stop", "start", "stop", "taps")


def judged(number: int, rig: Rig = RIG) -> Judged:
    """Align the run of a number and compare."""
    run = random_run(number, rig)
    fit, findings = fitted_clock(run.clock, run.channels, run.reference, run.run, run.priors)
    fatal = tuple(f"{item.kind}: {item.text}" for item in findings if item.severity == Severity.FATAL)
    error = fit.offset - run.offset
    outcome: Outcome = "refused" if fatal else "fitted"
    if not fatal and abs(error) > _other_cycle(run):
        outcome = "wrong cycle"
    return Judged(
        run.number, run.kind, run.transients, run.stamps, run.gaps, run.length, run.frequency, run.rates,
        outcome, fatal, error, fit.offset_error, fit.drift - run.drift, fit.drift_error, run.bound,
    )  # fmt: skip


def _other_cycle(run: SyntheticRun) -> float:
    cycle = OTHER_CYCLE / run.frequency
    return min(BOUNCE, cycle) if run.transients in ("taps", "knocks alone") else cycle
