"""One channel of a run as the metrics see it: both sides, their lines, and replays with moved parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tethertest.compare.alignment import Band, Pair, pair_with
from tethertest.compare.decision import Uncertainty, decide, few_draws_factor
from tethertest.records.channel import Channel, Window
from tethertest.records.comparison import Metric, Verdict
from tethertest.records.lines import ChannelLines
from tethertest.records.rig import Limits


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """One channel with everything its metrics need."""

    measured: Channel
    replayed: Channel
    window: Window
    drive: float  #: [Hz]
    pair: Pair
    measured_lines: ChannelLines | None
    replayed_lines: ChannelLines | None
    moved: tuple[Channel, ...]  #: on a coarser mesh: nominal first, then one parameter moved at a time
    moved_pairs: tuple[Pair, ...]  #: of `moved`
    members: tuple[Channel, ...]  #: of a slack cable on a coarser mesh: nominal first, then what nobody knows
    member_pairs: tuple[Pair, ...]  #: of `members`
    clock_error: float  #: standard uncertainty of the time between bottom motion and this channel [s]
    static: float | None  #: tension at rest [N]
    limits: Limits
    limited: bool  #: limits of the rig apply to it

    def input_uncertainty(self, values: Sequence[float]) -> float:
        """Return the root sum of squares of a metric's changes from the first, nominal, replay."""
        if len(values) < 2:
            return 0.0
        return float(np.sqrt(np.sum((np.array(values[1:]) - values[0]) ** 2)))

    def budget(
        self, data: float, value: float, values: Sequence[float], members: Sequence[float] = ()
    ) -> Uncertainty:
        """Return the uncertainty of a metric.

        Parameters
        ----------
        data : float
            Standard uncertainty from calibration and noise.
        value : float
            The metric of the replay itself.
        values : sequence of float
            The metric of `moved`: the first differs from `value` by the mesh alone.
        members : sequence of float
            The metric of `members`: the others are draws of what nobody knows, as far from the first as this
            one may be from what is right. So few draws know their own spread badly: it is widened so that the
            guard band keeps its chance.
        """
        numerical = abs(value - values[0]) if values else 0.0
        slack = 0.0
        if len(members) > 1:
            distance = np.array(members[1:]) - members[0]
            slack = few_draws_factor(distance.size) * float(np.sqrt(np.mean(distance**2)))
        return Uncertainty(data, self.input_uncertainty(values), numerical, slack)

    def over_pairs(self, data: float, metric: Callable[[Pair], float]) -> Uncertainty:
        """Return the uncertainty of a metric of a `Pair`."""
        moved, members = ([metric(pair) for pair in pairs] for pairs in (self.moved_pairs, self.member_pairs))
        return self.budget(data, metric(self.pair), moved, members)

    def metric(
        self,
        name: str,
        unit: str,
        measured: float | None,
        replayed: float | None,
        error: float,
        uncertainty: Uncertainty,
        limit: float | None,
        note: str = "",
    ) -> Metric:
        """Return a metric decided by the rule of the rig's limits."""
        verdict, reason = decide(
            error, uncertainty, limit if self.limited else None, self.limits.decision, unit == "rad"
        )
        text = f"{reason}; {note}" if note else reason
        return Metric(
            name,
            self.measured.name,
            unit,
            measured,
            replayed,
            error,
            uncertainty.total,
            limit if self.limited else None,
            verdict,
            text,
        )


def undecided(name: str, channel: str, unit: str, limit: float | None, reason: str) -> Metric:
    """Return a metric that could not be formed: undecided with a limit, informative without."""
    verdict = Verdict.INFORMATIVE if limit is None else Verdict.UNDECIDED
    return Metric(name, channel, unit, None, None, 0.0, 0.0, limit, verdict, reason)


def paired(band: Band, channels: Sequence[Channel]) -> tuple[Pair, ...]:
    """Pair a measurement with several replays, leaving out those that do not cover the window."""
    pairs = (pair_with(band, channel) for channel in channels)
    return tuple(pair for pair in pairs if not isinstance(pair, str))
