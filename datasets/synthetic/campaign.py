"""The runs of the campaign: what is driven, how, with which loggers, with which flaws."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta, timezone

from .motion import BaseMotion, Drive, Tap

LAB = timezone(timedelta(hours=8))
REST = 6.0
RAMP_UP = 7.0
RAMP_DOWN = 6.0
REST_AFTER = 8.0
TAPS_BEFORE = ((2.13, 0.55e-3), (3.68, 0.50e-3))
TAPS_AFTER = ((1.94, 0.50e-3), (4.31, 0.60e-3))
QUIET_DURATION = 60.0
LEAN = 0.02
"""Sideways offset of the top in runs with much slack: a vertical chain would turn inside out."""


@dataclass(frozen=True)
class Plan:
    """One run.

    Parameters
    ----------
    name, title : str
        Folder and title of the run.
    date : datetime
        The laboratory's time at true time zero.
    mode : str
        The UAV's mode.
    frequency, radius : float
        Crank speed in Hz and radius in m.
    turns : int
        Whole turns of the crank from start to stop.
    tension, optical, encoder : str
        Layout of each log.
    tension_rate : int
        Samples per second of the load cells.
    cells : int
        Cable segments of the truth; the spread is against half or twice as many.
    other_cells : int
        Cable segments of the comparison.
    offset : float
        Sideways offset of the top in m, for runs that go slack.
    gear_error : float
        Displacement at half the crank's speed in m.
    settling : float
        Time at full speed before the run is steady, in s.
    flaws : tuple of str
        Names of the flaws put into the logs.
    """

    name: str
    title: str
    date: datetime
    mode: str
    frequency: float = 0.0
    radius: float = 0.0
    turns: int = 0
    tension: str = "tdms"
    optical: str = "sensors"
    encoder: str = "relative"
    tension_rate: int = 1000
    cells: int = 20
    other_cells: int = 10
    offset: float = 0.0
    gear_error: float = 0.0
    settling: float = 1.0
    flaws: tuple[str, ...] = ()

    @property
    def drive(self) -> Drive:
        """The crank's motion, ending at its home mark."""
        if self.frequency == 0.0:
            return Drive()
        steady = self.turns / self.frequency - 0.5 * (RAMP_UP + RAMP_DOWN)
        stop = REST + RAMP_UP + steady
        return Drive(self.frequency, self.radius, REST, RAMP_UP, stop, RAMP_DOWN, self.gear_error)

    @property
    def driven_until(self) -> float:
        """True time at which the crank stands still again."""
        if self.frequency == 0.0:
            return QUIET_DURATION - REST_AFTER
        return self.drive.stop + RAMP_DOWN

    @property
    def duration(self) -> float:
        """Length of the run in s, rounded up to a tenth."""
        return round(self.driven_until + REST_AFTER, 1)

    @property
    def taps(self) -> tuple[Tap, ...]:
        """The knocks on the base plate."""
        before = tuple(Tap(start, height) for start, height in TAPS_BEFORE)
        after = tuple(Tap(self.driven_until + start, height) for start, height in TAPS_AFTER)
        return before + after

    @property
    def motion(self) -> BaseMotion:
        """What the base does."""
        return BaseMotion(self.drive, self.taps)

    @property
    def number(self) -> int:
        """The run's number."""
        return int(self.name.removeprefix("run"))


def _at(day: int, hour: int, minute: int) -> datetime:
    """Return a time of September 2026 in the laboratory."""
    return datetime(2026, 9, day, hour, minute, tzinfo=LAB)


PLANS: tuple[Plan, ...] = (
    Plan("run01", "quiet, no drive, UAV free", _at(5, 9, 10), "free",
         tension="lvm", tension_rate=500),
    Plan("run02", "0.1 Hz, 0.1 m, loose position loop", _at(5, 9, 40), "soft", 0.1, 0.1, 7,
         encoder="iso"),
    Plan("run03", "0.2 Hz, 0.1 m, loose position loop", _at(5, 10, 5), "soft", 0.2, 0.1, 8,
         tension="catman", tension_rate=500),
    Plan("run04", "0.3 Hz, 0.1 m, loose position loop", _at(5, 10, 30), "soft", 0.3, 0.1, 12,
         tension="lvm", tension_rate=500, encoder="split"),
    Plan("run05", "0.33 Hz, 0.1 m, loose position loop", _at(5, 11, 0), "soft", 0.33, 0.1, 13),
    Plan("run06", "0.3 Hz, 0.05 m, UAV held", _at(5, 11, 25), "hold", 0.3, 0.05, 12,
         tension="lvm-comma", tension_rate=500, encoder="iso"),
    Plan("run07", "0.3 Hz, 0.15 m, loose position loop", _at(5, 14, 20), "soft", 0.3, 0.15, 12),
    Plan("run08", "0.3 Hz, 0.2 m, UAV free", _at(5, 14, 45), "free", 0.3, 0.2, 12,
         tension="catman-kn", tension_rate=500, encoder="split"),
    Plan("run09", "1 Hz, 0.05 m, UAV free", _at(7, 9, 15), "free", 1.0, 0.05, 40,
         optical="peaks"),
    Plan("run10", "2 Hz, 0.02 m, UAV free", _at(7, 9, 45), "free", 2.0, 0.02, 80,
         tension="lvm", tension_rate=500, encoder="iso"),
    Plan("run11", "3 Hz, 0.01 m, UAV held", _at(7, 10, 10), "hold", 3.0, 0.01, 120,
         tension="catman-comma", tension_rate=500),
    Plan("run12", "0.3 Hz, 0.15 m, UAV held: slack and snap", _at(7, 13, 35), "hold", 0.3, 0.15,
         12, encoder="split", other_cells=40, offset=LEAN),
    Plan("run13", "0.3 Hz, 0.2 m, UAV held: slack and snap", _at(7, 14, 5), "hold", 0.3, 0.2, 12,
         tension="lvm", other_cells=40, offset=LEAN),
    Plan("run14", "2 Hz, 0.06 m, UAV held: slack every period", _at(7, 14, 40), "hold", 2.0, 0.06, 80,
         encoder="iso", other_cells=40),
    Plan("run15", "7.5 Hz, 0.009 m, UAV held: period two of the slack tether", _at(8, 9, 20), "hold",
         7.5, 0.009, 300, other_cells=40, settling=5.0),
    Plan("run16", "0.3 Hz, 0.1 m, loose position loop, gear error at half speed", _at(8, 9, 50),
         "soft", 0.3, 0.1, 12, tension="catman", tension_rate=500, encoder="split",
         gear_error=3e-3),
    Plan("run17", "as run13, top amplifier's range too small", _at(8, 10, 20), "hold", 0.3, 0.2,
         12, encoder="iso", flaws=("saturated",), other_cells=40, offset=LEAN),
    Plan("run18", "as run04, a grating is lost now and then", _at(8, 10, 45), "soft", 0.3, 0.1,
         12, tension="lvm", tension_rate=500, optical="peaks", flaws=("lost-grating",)),
    Plan("run19", "as run07, bottom load cell freezes", _at(8, 11, 10), "soft", 0.3, 0.15, 12,
         encoder="split", flaws=("stuck",)),
    Plan("run20", "as run05, interrogator's clock jumps", _at(8, 13, 30), "soft", 0.33, 0.1, 13,
         tension="catman", tension_rate=500, flaws=("clock-jump",)),
    Plan("run21", "as run06, spikes, hum and dropped rows", _at(8, 14, 0), "hold", 0.3, 0.05, 12,
         encoder="iso", flaws=("spikes", "hum", "dropped")),
    Plan("run22", "as run09, encoder's day and month swapped", _at(8, 14, 30), "free", 1.0, 0.05,
         40, tension="lvm", tension_rate=500, encoder="iso", flaws=("swapped-date",)),
)  # fmt: skip
