"""npTDMS' file with the history of its properties; imported when a TDMS file is opened."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from nptdms import TdmsFile

from tethertest.readers.formats.tdms_time import MEANING, TIME


class FileWithHistory(TdmsFile):  # type: ignore[misc]
    """A TDMS file that remembers what its segments said, where npTDMS keeps the last word alone."""

    def _read_file(self, tdms_reader: Any, *options: Any) -> None:
        #: path -> number of samples before, and what was said then and before
        self.history: dict[str, list[tuple[int, dict[str, Any]]]] = {}
        counts: dict[str, int] = {}
        update: Callable[[Any], None] = tdms_reader._update_object_properties

        def noted(properties: Any) -> None:
            for path, pairs in (properties or {}).items():
                self._note(path, counts.get(path, 0), pairs)
            update(properties)
            counts.update((path, found.num_values) for path, found in tdms_reader.object_metadata.items())

        tdms_reader._update_object_properties = noted
        super()._read_file(tdms_reader, *options)

    def _note(self, path: str, count: int, pairs: Iterable[tuple[str, Any]]) -> None:
        said = {key: value for key, value in pairs if key in TIME or key.startswith(MEANING)}
        past = self.history.setdefault(path, [])
        known = past[-1][1] if past else {}
        if said.items() <= known.items():
            return
        if past and (past[-1][0] == count or not any(key in known for key in said)):
            known |= said  # nothing was recorded since, or it was never said before
        else:
            past.append((count, known | said))
