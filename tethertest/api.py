"""What a script or a notebook calls; every function returns a record with ``to_pandas()`` and ``plot()``.

The command line does the same by the same functions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from tethertest.jobs.analysis_options import MAINS, Options
from tethertest.jobs.analyze import analyze as analyze_path
from tethertest.jobs.evaluation import open_evaluation
from tethertest.jobs.read_bare import read_bare
from tethertest.jobs.report import make_report
from tethertest.jobs.scale import scale_rig
from tethertest.records.analysis import Analysis
from tethertest.records.channel import ConditionedRun, RawLog
from tethertest.records.report import Report
from tethertest.records.similarity import Similarity


def read_log(path: Path | str, *, units: Mapping[str, str] | None = None, **settings: str | float) -> RawLog:
    """Read a log of any format that is known, as it was logged.

    Parameters
    ----------
    path : Path or str
        The log.
    units : mapping, optional
        Channel -> unit, where the file says none.
    **settings
        Keys of a ``[[log]]`` entry, where the file leaves something open: ``time="t"``, ``rate="100 Hz"``.

    Raises
    ------
    TethertestError
        The file cannot be read, or a setting is wrong.
    """
    words = [f"{key}={value}" for key, value in settings.items()]
    words += [f"units.{name}={unit}" for name, unit in (units or {}).items()]
    return read_bare(Path(path), words)


def condition(path: Path | str, rigs: Path | str | None = None) -> ConditionedRun:
    """Return a run's channels, calibrated, tared and flagged, on one clock, in SI.

    Parameters
    ----------
    path : Path or str
        A run folder, or a run store.
    rigs : Path or str, optional
        Folder of rig files; found upwards from the run folder if absent.

    Raises
    ------
    TethertestError
        Anything in the files that the user can mend.
    """
    evaluation = open_evaluation(Path(path), Options(rigs=_folder(rigs)))
    with evaluation.errors_placed():
        return evaluation.measured


def report(folder: Path | str, output: Path | str | None = None, rigs: Path | str | None = None) -> Report:
    """Hold a run against its replay, and return what the validation report says.

    Parameters
    ----------
    folder : Path or str
        Run folder with run.toml and raw logs.
    output : Path or str, optional
        Folder for the page and summary.json; nothing is written if absent.
    rigs : Path or str, optional
        Folder of rig files; found upwards from the run folder if absent.

    Raises
    ------
    TethertestError
        Anything in the files that the user can mend, or a folder that cannot be written.
    """
    made = make_report(Path(folder), _folder(rigs))
    if output is not None:
        from tethertest.render import write_report

        write_report(made, Path(output))
    return made


def analyze(
    path: Path | str,
    *,
    channels: Sequence[str] = (),
    drive_frequency: float | None = None,
    window: tuple[float, float] | None = None,
    natural_frequencies: Sequence[float] = (),
    mains: float = MAINS,
    replay: bool = False,
    rigs: Path | str | None = None,
) -> Analysis:
    """Find lines with verdicts, slack, snaps, load cycles and waves.

    Parameters
    ----------
    path : Path or str
        A run folder, a run store, or any log.
    channels : sequence of str
        Names; all that fit where empty.
    drive_frequency : float, optional
        Nominal frequency of the drive [Hz]; the run file's own if absent.
    window : tuple of float, optional
        Start and stop [s]; the steady window is found if absent.
    natural_frequencies : sequence of float
        Known ones [Hz], beside those of the run's scene.
    mains : float
        [Hz].
    replay : bool
        Analyse the replayed channels of a run too.
    rigs : Path or str, optional
        Folder of rig files; found upwards from the run folder if absent.

    Raises
    ------
    TethertestError
        The path cannot be read, or cannot be analysed as asked.
    """
    options = Options(
        channels=tuple(channels),
        drive_frequency=drive_frequency,
        window=window,
        natural_frequencies=tuple(natural_frequencies),
        mains=mains,
        replay=replay,
        rigs=_folder(rigs),
    )
    return analyze_path(Path(path), options)


def scale(
    rig: Path | str,
    prototype: Path | str | None = None,
    *,
    frequency: str = "0.3 Hz",
    amplitude: str = "0.1 m",
    mode: str = "free",
) -> Similarity:
    """Return the groups of a rig beside those of its prototype, and how far they are from alike.

    Parameters
    ----------
    rig : Path or str
        Rig file.
    prototype : Path or str, optional
        Prototype file; the one that the rig names if absent.
    frequency, amplitude : str
        Drive on the rig, with units.
    mode : str
        Platform mode of the rig.

    Raises
    ------
    TethertestError
        A file, quantity or mode is wrong.
    """
    return scale_rig(Path(rig), _folder(prototype), frequency, amplitude, mode)


def _folder(path: Path | str | None) -> Path | None:
    return None if path is None else Path(path)
