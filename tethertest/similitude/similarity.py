"""Model against prototype: groups and their distortion, ratios, and demands that are at odds."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction

from tethertest.records.rig import Prototype, Rig
from tethertest.records.similarity import PiGroup, Similarity, Variable
from tethertest.similitude.conflicts import conflicts
from tethertest.similitude.demands import Demand, kept, same, scaled
from tethertest.similitude.distortion import MATCHED_WITHIN, judged
from tethertest.similitude.groups import diagnose, value_of
from tethertest.similitude.rational import rank
from tethertest.similitude.sets import TETHER_GROUPS, NamedGroup
from tethertest.similitude.variables import Motion, tether_variables

#: groups that a drive frequency of the prototype could match
FREQUENCY_GROUPS = ("w L/cl", "w L/ct", "w^2 L/g")


def similarity(
    rig: Rig,
    prototype: Prototype,
    drive_frequency: float | None,
    amplitude: float | None,
    mode: str,
    *,
    prototype_frequency: float | None = None,
    prototype_amplitude: float | None = None,
) -> Similarity:
    """Return groups, distortion and ratios of a run on a rig against its prototype.

    Parameters
    ----------
    rig, prototype : Rig, Prototype
        Model and prototype.
    drive_frequency, amplitude : float or None
        Drive of the run [Hz], [m]; None for a run without drive, which leaves out the groups that need it.
    mode : str
        Platform mode of the run.
    prototype_frequency : float, optional
        Heave frequency of the prototype [Hz]; without it that of the run, as in the source article.
    prototype_amplitude : float, optional
        Heave amplitude of the prototype [m]; without it the run's times the length ratio.

    Returns
    -------
    Similarity
        Ratios are prototype over model, ``ratio`` of a group is model over prototype. Groups that a file
        gives no values for, or that are zero at both scales, are left out and listed in the remarks.
        ``conflicts`` are sets of what the pair has in common of which, at this length ratio, no set can hold
        together with all groups matched: they say why a group is distorted.

    Raises
    ------
    DataError
        The rig has no such platform mode.
    """
    length_ratio = prototype.cable.length / rig.cable.length
    run = Motion(drive_frequency, amplitude)
    frequency = drive_frequency if prototype_frequency is None else prototype_frequency
    heave = amplitude * length_ratio if amplitude is not None else None
    sea = Motion(frequency, heave if prototype_amplitude is None else prototype_amplitude)
    variables = tether_variables(rig, prototype, mode, run, sea)
    groups, left_out = _judged_groups(variables)
    remarks = [
        *_length_state_remarks(rig, prototype),
        *_sea_remarks(prototype, sea),
        *_frequency_remarks(groups, sea),
        *_count_remarks(groups, variables),
    ]
    if amplitude is not None and prototype_amplitude is None:
        remarks.append("the prototype's heave amplitude is the run's times the length ratio, so Ae/L matches")
    if left_out:
        remarks.append(f"left out, not given or zero at both scales: {', '.join(left_out)}")
    return Similarity(
        groups=groups,
        ratios=_ratios({variable.name: variable for variable in variables}),
        conflicts=_conflicts(variables, groups),
        rank=diagnose(variables).rank,
        remarks=tuple(remarks),
    )


def _judged_groups(variables: Sequence[Variable]) -> tuple[tuple[PiGroup, ...], tuple[str, ...]]:
    """Return the groups that have values at both scales, and the names of the others."""
    groups, left_out = [], []
    for named in TETHER_GROUPS:
        model, prototype = (
            _group_value(named, variables, "model"),
            _group_value(named, variables, "prototype"),
        )
        if model is None or prototype is None or model == prototype == 0.0:
            left_out.append(named.name)
        else:
            group = PiGroup(named.name, dict(named.exponents), meaning=named.meaning)
            groups.append(judged(group, model, prototype))
    return tuple(groups), tuple(left_out)


def _group_value(named: NamedGroup, variables: Sequence[Variable], scale: str) -> float | None:
    values = {variable.name: getattr(variable, scale) for variable in variables}
    if any(values[name] is None for name in named.exponents):
        return None
    return value_of(named.exponents, values)


def _ratios(variables: Mapping[str, Variable]) -> dict[str, float]:
    """Return the ratios, prototype over model, of what has a value above zero at both scales."""
    simple = {
        "length": "length",
        "mass_per_length": "mass_per_length",
        "axial_stiffness": "axial_stiffness",
        "force": "static_tension",
        "mass": "platform_mass",
        "hover_stiffness": "hover_stiffness",
        "hover_damping": "hover_damping",
        "amplitude": "amplitude",
        "frequency": "angular_frequency",
    }
    ratios = {}
    for name, variable in simple.items():
        ratio = _ratio(variables[variable])
        if ratio is not None:
            ratios[name] = ratio
    ratios["cable_mass"] = ratios["mass_per_length"] * ratios["length"]
    if "axial_stiffness" in ratios:
        ratios["strain"] = ratios["force"] / ratios["axial_stiffness"]
        ratios["axial_wave_speed"] = math.sqrt(ratios["axial_stiffness"] / ratios["mass_per_length"])
    ratios["lateral_wave_speed"] = math.sqrt(ratios["force"] / ratios["mass_per_length"])
    if "frequency" in ratios:
        ratios["time"] = 1.0 / ratios["frequency"]
    if "frequency" in ratios and "amplitude" in ratios:
        ratios["velocity"] = ratios["amplitude"] * ratios["frequency"]
        ratios["acceleration"] = ratios["amplitude"] * ratios["frequency"] ** 2
    return ratios


def _ratio(variable: Variable) -> float | None:
    if not variable.model or not variable.prototype:
        return None
    return variable.prototype / variable.model


def _conflicts(variables: Sequence[Variable], groups: Sequence[PiGroup]) -> tuple[tuple[str, ...], ...]:
    by_name = {variable.name: variable for variable in variables}
    length_ratio = _ratio(by_name["length"])
    used = {name for group in groups for name in group.exponents}
    shared = [name for name in sorted(used - {"length"}) if _is_shared(by_name[name])]
    demands = [
        Demand("same frequency", same(name).exponents) if name == "angular_frequency" else same(name)
        for name in shared
    ]
    background = [*kept({group.name: group.exponents for group in groups})]
    if length_ratio is not None:
        background.append(scaled("length", length_ratio))
    return conflicts(demands, background)


def _is_shared(variable: Variable) -> bool:
    ratio = _ratio(variable)
    return ratio is not None and max(ratio, 1.0 / ratio) <= MATCHED_WITHIN


def _length_state_remarks(rig: Rig, prototype: Prototype) -> list[str]:
    if rig.cable.length_state == prototype.cable.length_state:
        return []
    return [
        f"the rig's length is {rig.cable.length_state}, the prototype's {prototype.cable.length_state}: the "
        f"length ratio is off by the stretch at rest"
    ]


def _sea_remarks(prototype: Prototype, sea: Motion) -> list[str]:
    remarks = []
    for name, value, (low, high), unit in (
        ("frequency", sea.frequency, prototype.sea.frequency, "Hz"),
        ("amplitude", sea.amplitude, prototype.sea.amplitude, "m"),
    ):
        if value is not None and not low <= value <= high:
            span = f"{low:g} to {high:g} {unit}"
            remarks.append(f"the prototype's heave {name} of {value:.4g} {unit} is outside its sea of {span}")
    return remarks


def _frequency_remarks(groups: Sequence[PiGroup], sea: Motion) -> list[str]:
    """Tell at which heave frequency of the prototype each frequency group would be matched."""
    if sea.frequency is None:
        return []
    wanted = []
    for group in groups:
        if group.name in FREQUENCY_GROUPS and group.ratio:
            power = float(group.exponents["angular_frequency"])
            wanted.append(f"{group.name} at {sea.frequency * group.ratio ** (1.0 / power):.4g} Hz")
    return [f"matched by another heave frequency of the prototype: {', '.join(wanted)}"] if wanted else []


def _count_remarks(groups: Sequence[PiGroup], variables: Sequence[Variable]) -> list[str]:
    names = [variable.name for variable in variables]
    rows = [[group.exponents.get(name, Fraction(0)) for name in names] for group in groups]
    independent = rank(rows)
    if independent == len(groups):
        return []
    return [f"{independent} of the {len(groups)} groups are independent; the others are products of these"]
