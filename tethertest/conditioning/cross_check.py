"""Gratings against load cells: axial stiffness times strain is the tension, or something is wrong."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.inertia import Inertia
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Finding, Severity, Window
from tethertest.records.rig import Rig
from tethertest.signal.passes import BLOCK as SAMPLES

#: both are compared as means over this time [s]: noise averages out and clocks need not agree to a sample
BLOCK = 0.05
#: a block counts with at least this share of its samples
FULL_BLOCK = 0.5
#: stretches left out in turn for the standard error of the gain (jackknife)
STRETCHES = 10
#: fewer blocks than this tell nothing
FEWEST_BLOCKS = 40
#: nor does a tension that moves by less than this many standard errors of a block
TELLING = 5.0
#: a gain this many standard uncertainties from 1 is a disagreement
COVERAGE = 3.0
#: and a known slip explains it within this, or within the coverage
EXPLAINED = 0.08
#: what a gain of strain over tension may come from; first match is named first
SLIPS: tuple[tuple[float, str], ...] = (
    (-1.0, "a sign: the load cell or the grating is connected or defined the other way round"),
    (1e3, "a factor 1000: tension in kN read as N, or a wavelength in pm read as nm"),
    (1e-3, "a factor 1/1000: tension in N read as kN, or a stiffness in kN read as N"),
    (1e6, "a factor 1e6: strain in microstrain read as strain"),
    (1e-6, "a factor 1e-6: strain read as microstrain"),
    (4.4482216, "4.448: tension in lbf read as N"),
    (1.0 / 4.4482216, "1/4.448: tension in N read as lbf"),
    (9.80665, "9.81: tension in kgf read as N"),
    (1.0 / 9.80665, "1/9.81: tension in N read as kgf"),
)
#: kind of the warnings, and how they begin
KIND = "strain_against_tension"
PRODUCT = "axial stiffness times strain"
RECTANGLE = 1.0 / np.sqrt(3.0)


@dataclass(frozen=True, slots=True)
class Gain:
    """Axial stiffness times strain over tension, of one grating against the tension at its place."""

    grating: str
    cells: tuple[str, ...]  #: the load cells between which the tension was interpolated, or the one
    gain: float
    uncertainty: float  #: standard, of the gain
    offset: float  #: stiffness times strain less the change of tension since rest, at mean tension [N]
    offset_uncertainty: float  #: standard [N]

    @property
    def agrees(self) -> bool:
        """Whether the gain is 1 within its uncertainty."""
        return abs(self.gain - 1.0) <= COVERAGE * self.uncertainty


def gains(
    channels: Sequence[Channel],
    rig: Rig,
    window: Window,
    static: Mapping[str, float],
    inertia: Inertia,
    unaligned: Collection[str] = (),
) -> tuple[Gain, ...]:
    """Return the gain of every grating against each load cell, and against both where there are two.

    Where there are two load cells, the lower one against the upper one comes last.

    Parameters
    ----------
    channels : sequence of Channel
        Conditioned tensions [N] and strains on one clock.
    rig : Rig
        Axial stiffness, uncertainties.
    window : Window
        Where to compare.
    static : mapping
        Tension at rest by load cell [N].
    inertia : Inertia
        What the cable's own inertia adds between its ends.
    unaligned : collection of str
        Clocks that could not be aligned: their gratings are compared by the size of their motion alone.
    """
    stiffness = rig.cable.axial_stiffness
    if stiffness is None:
        return ()
    cells = [item for item in channels if item.kind == "tension" and item.at is not None]
    cells = sorted(cells, key=lambda item: item.at or 0.0)
    strains = [item for item in channels if item.kind == "strain" and item.at is not None]
    edges = np.arange(window.start, window.stop, BLOCK)
    if edges.size <= FEWEST_BLOCKS:
        return ()
    tensions = [_blocks(cell, edges) - static.get(cell.name, 0.0) for cell in cells]
    found: list[Gain] = []
    for strain in strains:
        values = stiffness * _blocks(strain, edges)
        adrift = strain.source is not None and strain.source.clock in unaligned
        if len(cells) > 1:
            low, high = cells[0], cells[-1]
            share = ((strain.at or 0.0) - (low.at or 0.0)) / max((high.at or 1.0) - (low.at or 0.0), 1e-9)
            between = (1.0 - share) * tensions[0] + share * tensions[-1]
            # a curved course of the tension between the ends, at most an eighth of what inertia adds
            unknown = _unknown(strain, (low, high), rig, stiffness, inertia.force / 8.0)
            item = _gain(strain.name, (low, high), values, between, unknown, adrift=adrift)
            found += [item] if item else []
        for cell, tension in zip(cells, tensions, strict=True):
            away = abs((strain.at or 0.0) - (cell.at or 0.0))
            unknown = _unknown(strain, (cell,), rig, stiffness, inertia.force * away)
            item = _gain(strain.name, (cell,), values, tension, unknown, adrift=adrift)
            found += [item] if item else []
    if len(cells) > 1:
        low, high = cells[0], cells[-1]
        unknown = _Unknown(
            low.noise / np.sqrt(max(BLOCK * low.rate, 1.0)),
            float(np.hypot(low.uncertainty, high.uncertainty)),
            inertia.force * ((high.at or 1.0) - (low.at or 0.0)),
            float(np.hypot(low.offset_uncertainty, high.offset_uncertainty)),
        )
        item = _gain(low.name, (high,), tensions[0], tensions[-1], unknown)
        found += [item] if item else []
    return tuple(found)


def cross_findings(found: Sequence[Gain], rig: Rig, doubt: str = "") -> tuple[Finding, ...]:
    """Return a note with all gains, and a warning for each disagreement with what would explain it.

    Parameters
    ----------
    found : sequence of Gain
        As `gains` returns them.
    rig : Rig
        For gauge factors.
    doubt : str
        Why the cable's inertia, and so the uncertainty of the gains, is not better known.
    """
    kinds = {sensor.name: sensor.kind for sensor in rig.sensor}
    pair = next((item for item in found if kinds.get(item.grating) == "tension"), None)
    # load cells that contradict each other have no tension between them
    torn = pair is not None and not pair.agrees
    optical = [item for item in found if item is not pair and not (torn and len(item.cells) > 1)]
    findings = _of_gratings(optical, rig, doubt) if optical else []
    named = any(item.kind == KIND for item in findings)
    if pair is not None and torn and not named:
        words = f"{pair.grating} and {pair.cells[0]} disagree: the lower one"
        findings.append(_finding("load cells", words, [pair], rig, doubt))
    return tuple(findings)


def _of_gratings(found: Sequence[Gain], rig: Rig, doubt: str) -> list[Finding]:
    best = {item.grating: item for item in reversed(found)}  # against both cells where there are two
    listed = ", ".join(
        f"{item.grating} {item.gain:.4g} +/- {COVERAGE * item.uncertainty:.2g} "
        f"(offset {item.offset:+.2g} +/- {COVERAGE * item.offset_uncertainty:.2g} N)"
        for item in best.values()
    )
    text = f"axial stiffness times strain over tension, {COVERAGE:g} standard uncertainties: {listed}"
    text += f"; {doubt}" if doubt else ""
    findings = [Finding("cross-check", "strain_over_tension", text, Severity.NOTE)]
    wrong = [item for item in best.values() if not item.agrees]
    cell = _wrong_cell(found)
    if cell is not None:
        mine = [item for item in found if item.cells == (cell,)]
        findings.append(
            _finding(cell, f"all gratings disagree with {cell} alone: {PRODUCT}", mine, rig, doubt)
        )
    elif len(wrong) == len(best) > 1:
        by = " by one factor" if _common(wrong) else ""
        words = f"all gratings disagree with the tension{by}: {PRODUCT}"
        findings.append(_finding("cable", words, wrong, rig, doubt))
    else:
        words = f"strain and tension disagree: {PRODUCT}"
        findings += [_finding(item.grating, words, [item], rig, doubt) for item in wrong]
    return findings


def _finding(subject: str, words: str, items: Sequence[Gain], rig: Rig, doubt: str) -> Finding:
    gain = float(np.median([item.gain for item in items]))
    spread = COVERAGE * float(np.median([item.uncertainty for item in items]))
    known = list(SLIPS)
    factors = {sensor.gauge_factor for item in items if (sensor := rig.sensor_named(item.grating))}
    for factor in sorted(item for item in factors if item is not None):
        known.append((factor, f"{factor:g}: the gauge factor was left out, the log has strain as wavelength"))
        known.append((1.0 / factor, f"1/{factor:g}: the gauge factor was applied twice"))
    fits = [
        text
        for value, text in known
        if abs(gain / value - 1.0) <= max(EXPLAINED, spread / max(abs(gain), 1e-9))
    ]
    if fits:
        why = "explained by " + "; or ".join(fits)
    elif doubt:
        why = (
            f"no slip of units explains it; look at the motion before gauge factors and calibrations: {doubt}"
        )
    elif subject == "cable":
        why = "no slip of units explains it: look at axial_stiffness, then at gauge factors and calibrations"
    else:
        why = "no slip of units explains it: look at its gauge factor or calibration, or for another column"
    text = f"{words} is {gain:.4g} +/- {spread:.2g} of the tension; {why}"
    return Finding(subject, KIND, text)


def _wrong_cell(found: Sequence[Gain]) -> str | None:
    """Return the load cell with which all gratings disagree while they agree with the other one."""
    cells = sorted({item.cells[0] for item in found if len(item.cells) == 1})
    if len(cells) != 2:
        return None
    agree = {cell: [item.agrees for item in found if item.cells == (cell,)] for cell in cells}
    for cell, other in (cells, cells[::-1]):
        if len(agree[cell]) > 1 and not any(agree[cell]) and all(agree[other]):
            return cell
    return None


def _common(items: Sequence[Gain]) -> bool:
    values = np.array([item.gain for item in items])
    spread = COVERAGE * np.array([item.uncertainty for item in items])
    return bool(np.all(np.abs(values - np.median(values)) <= np.hypot(spread, EXPLAINED * abs(values))))


@dataclass(frozen=True, slots=True)
class _Unknown:
    """What is not known of two channels before they are compared."""

    noise: float  #: of a block mean of what is compared [N]
    relative: float  #: standard uncertainty of the scales
    inertia: float  #: standard deviation of what the cable's own inertia puts between them [N]
    offset: float  #: standard uncertainty of the zeros [N]


def _unknown(
    strain: Channel, cells: Sequence[Channel], rig: Rig, stiffness: float, inertia: float
) -> _Unknown:
    scale = np.sqrt(sum(cell.uncertainty**2 for cell in cells) / len(cells))
    own = rig.uncertainty.get("cable.axial_stiffness", 0.0) / stiffness
    zeros = [stiffness * strain.offset_uncertainty, *(cell.offset_uncertainty for cell in cells)]
    return _Unknown(
        stiffness * strain.noise / np.sqrt(max(BLOCK * strain.rate, 1.0)),
        float(np.linalg.norm([strain.uncertainty, own, scale])),
        inertia,
        float(np.linalg.norm(zeros)),
    )


def _gain(
    name: str,
    cells: Sequence[Channel],
    values: FloatArray,
    tension: FloatArray,
    unknown: _Unknown,
    *,
    adrift: bool = False,
) -> Gain | None:
    """Return the slope of values against tension with what is not known of it."""
    both = np.isfinite(values) & np.isfinite(tension)
    x, y = tension[both], values[both]
    if x.size < FEWEST_BLOCKS:
        return None
    noise = max(cell.noise for cell in cells) / np.sqrt(max(BLOCK * cells[0].rate, 1.0))
    moved = float(np.std(x))
    if moved <= TELLING * float(np.hypot(noise, unknown.noise)):
        return None
    slope = _size if adrift else _slope
    # noise of x flattens a least-squares slope by its share of the variance
    diluted = 1.0 + noise**2 / max(moved**2 - noise**2, noise**2)
    parts = np.array_split(np.arange(x.size), STRETCHES)
    left = np.array([slope(np.delete(x, part), np.delete(y, part)) for part in parts])
    error = float(np.sqrt((STRETCHES - 1) / STRETCHES * np.sum((left - left.mean()) ** 2)))
    gain = diluted * slope(x, y)
    relative = float(np.hypot(unknown.relative, RECTANGLE * unknown.inertia / moved))
    uncertainty = float(np.hypot(error, relative * abs(gain)))
    offset = float(y.mean() - gain * x.mean())
    spread = float(np.hypot(unknown.offset, uncertainty * abs(float(x.mean()))))
    return Gain(name, tuple(cell.name for cell in cells), gain, uncertainty, offset, spread)


def _size(x: FloatArray, y: FloatArray) -> float:
    """Return how far y moves over how far x moves, whatever their clocks say."""
    return float(np.std(y) / np.std(x))


def _slope(x: FloatArray, y: FloatArray) -> float:
    centred = x - x.mean()
    return float(np.sum(centred * (y - y.mean())) / max(np.sum(centred**2), np.finfo(float).tiny))


def _blocks(channel: Channel, edges: FloatArray) -> FloatArray:
    """Return means over `BLOCK`, NaN where samples lack or may not be used: a clipped peak has no mean."""
    together = max(int(SAMPLES / (BLOCK * channel.rate)), 1)
    parts = [edges[first : first + together + 1] for first in range(0, edges.size - 1, together)]
    return np.concatenate([_block_means(channel, part) for part in parts])


def _block_means(channel: Channel, edges: FloatArray) -> FloatArray:
    first, last = np.searchsorted(channel.time, edges[[0, -1]])
    part = channel.rows(int(first), int(last))
    number = np.searchsorted(edges, part.time, "right") - 1
    usable = part.usable
    count = np.bincount(number, minlength=edges.size - 1)
    spoilt = np.bincount(number, weights=~usable, minlength=edges.size - 1) > 0
    values = np.where(usable, part.values, 0.0)
    total = np.bincount(number, weights=values, minlength=edges.size - 1)
    enough = (count >= max(FULL_BLOCK * BLOCK * channel.rate, 1.0)) & ~spoilt
    return np.where(enough, total / np.maximum(count, 1), np.nan)
