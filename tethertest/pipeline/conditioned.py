"""The measured side of a run folder, as the report and the run store both need it."""

from __future__ import annotations

from collections.abc import Mapping

from tethertest.conditioning import Guide, condition
from tethertest.errors import DataError
from tethertest.readers import read_log
from tethertest.records.channel import ConditionedRun, RawLog
from tethertest.records.run import Run
from tethertest.replay import expected_bottom_tension, rest_tensions


def read_logs(run: Run) -> dict[str, RawLog]:
    """Read the logs of a run, by their `Log.key`.

    Raises
    ------
    FileFormatError
        A log cannot be read.
    """
    return {log.key: read_log(run.folder / log.file, log) for log in run.file.log}


def conditioned(run: Run, logs: Mapping[str, RawLog]) -> ConditionedRun:
    """Condition the logs of a run with what the rig's mechanics says beforehand.

    Raises
    ------
    DataError
        As `tethertest.conditioning.condition`; see `placed`.
    """
    return condition(run, logs, guide(run))


def guide(run: Run) -> Guide:
    """Return what the solver tells the conditioning of a run."""
    return Guide(
        static_tension=rest_tensions(run.rig),
        expected_tension=expected_bottom_tension(run),
        drive_frequency=run.file.drive.frequency,
    )


def placed(error: DataError, run: Run) -> DataError:
    """Return the error with the file's place; what no log is to blame for is mended in run.toml."""
    name = error.path or "run.toml"
    path = run.folder / name if error.path is None or name in {log.file for log in run.file.log} else name
    return DataError(error.problem, error.remedy, path=path, line=error.line)
