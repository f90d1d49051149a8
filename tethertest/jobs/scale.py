"""A rig against its prototype."""

from __future__ import annotations

from pathlib import Path

from tethertest.errors import TethertestError
from tethertest.jobs.parse_option import AMPLITUDE, FREQUENCY, parse_option
from tethertest.readers import load_prototype, load_prototype_of, load_rig
from tethertest.records.similarity import Similarity
from tethertest.similitude import similarity


def scale_rig(
    rig_path: Path, prototype_path: Path | None, frequency: str, amplitude: str, mode: str
) -> Similarity:
    """Return groups, ratios and distortion of a rig against a prototype.

    Parameters
    ----------
    rig_path : Path
        Rig file.
    prototype_path : Path or None
        Prototype file; None takes the one that the rig names.
    frequency, amplitude : str
        Drive on the rig, with units.
    mode : str
        Platform mode of the rig.

    Raises
    ------
    TethertestError
        A file, quantity or mode is wrong.
    """
    rig = load_rig(rig_path)
    prototype = load_prototype_of(rig, rig_path) if prototype_path is None else load_prototype(prototype_path)
    if prototype is None:
        message = "the rig names no prototype"
        raise TethertestError(message, "name one with --to PROTOTYPE.toml", path=rig_path)
    if mode not in rig.platform.modes:
        message = f"platform mode {mode!r} is not one of {', '.join(rig.platform.modes)}"
        raise TethertestError(message, "name one of the rig's modes with --mode", path=rig_path)
    drive = (
        parse_option("--frequency", frequency, FREQUENCY),
        parse_option("--amplitude", amplitude, AMPLITUDE),
    )
    return similarity(rig, prototype, *drive, mode)
