"""What a report was made from and with."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from importlib.metadata import version

from tethertest.readers.fingerprint import file_sha256
from tethertest.records.channel import RawLog
from tethertest.records.report import Provenance
from tethertest.records.run import Run

#: packages whose version can change a number in a report
_PACKAGES = ("tethertest", "numpy", "scipy", "numba", "pandas", "npTDMS", "pint", "matplotlib")


def provenance(run: Run, logs: Mapping[str, RawLog], settings: Mapping[str, str]) -> Provenance:
    """Return versions, file hashes and settings.

    Parameters
    ----------
    run : Run
        Its run and rig file are hashed, and the prototype file that the rig names.
    logs : mapping of str to RawLog
        By file name; they are hashed as they were read.
    settings : mapping of str to str
        What the program chose.
    """
    files = [run.folder / "run.toml", run.rig_path]
    if run.rig.prototype is not None:
        files.append(run.rig_path.with_name(f"{run.rig.prototype}.toml"))
    hashes = [(path.name, file_sha256(path)) for path in files if path.is_file()]
    hashes += [(name, log.sha256) for name, log in logs.items()]
    software = {name: version(name) for name in _PACKAGES}
    software["python"] = platform.python_version()
    return Provenance(software=software, files=tuple(hashes), settings=dict(settings))
