"""The text of a drafted run.toml: valid TOML whose TODO values stop a report until they are filled."""

from __future__ import annotations

import json
from pathlib import Path

from tethertest.jobs.draft import Draft, DraftLog, WrittenDraft, WrittenLog

#: a value that a person must replace; no key accepts it
TODO = "TODO"
#: settings of a log that a file may leave open, with what they look like
SETTINGS = (
    'decimal = ","',
    'separator = ";"',
    'date_order = "dmy"',
    'encoding = "gb18030"',
    'time_zone = "+08:00"',
)


def written_draft(path: Path, draft: Draft) -> WrittenDraft:
    """Return what was written to a path, and what is left to a person."""
    lines = enumerate(draft_text(draft).splitlines(), 1)
    return WrittenDraft(
        path=path,
        rig=None if draft.rig == TODO else draft.rig,
        logs=tuple(
            WrittenLog(
                log.file,
                log.format,
                None if log.clock == TODO else log.clock,
                log.matched.guessed,
                log.problem,
            )
            for log in draft.logs
        ),
        left_out=tuple(file for file, _ in draft.left_out),
        # the first two lines say what a TODO is
        todo=tuple(f"{number}: {line}" for number, line in lines if TODO in line and number > 2),
    )


def draft_text(draft: Draft) -> str:
    """Return run.toml as text."""
    folder = draft.folder.resolve().name
    lines = [
        "# Draft by `tethertest new` from the logs of this folder. Replace every TODO, check what is marked",
        "# as guessed, then run `tethertest report` on the folder; it says what is still missing.",
        f"id = {quoted(folder)}",
        'title = ""',
        _rig_line(draft),
        f"date = {draft.date}  # {draft.date_why}",
        'operator = ""',
        'purpose = "validation"  # or "calibration": such a run cannot validate',
        "",
        "[drive]",
    ]
    if draft.drive_hint:
        lines += comment(draft.drive_hint)
    lines += [
        f'kind = "{TODO}"  # crank-slider, harmonic, measured or none',
        f'frequency = "{TODO}"  # nominal, e.g. "0.3 Hz"; remove for kind none',
        f'radius = "{TODO}"  # of the crank, e.g. "0.1 m"; amplitude for a harmonic drive; else remove',
        "",
        "[platform]",
        f"mode = {quoted(draft.mode)}  # {_modes(draft)}",
    ]
    for log in draft.logs:
        lines += ["", *_log(log)]
    for file, why in draft.left_out:
        lines += ["", *comment(f"not used: {file}: {why}")]
    lines += [
        "",
        "# Windows and spans are found by the program; to decide by hand, with a reason:",
        "# [windows]",
        '# rest_before = ["0 s", "5 s"]',
        '# steady = ["20 s", "85 s"]',
        '# reason = "why"',
        "# [[exclude]]",
        '# channel = "tension_top"',
        '# span = ["41.2 s", "41.9 s"]',
        '# reason = "rig was touched"',
    ]
    return "\n".join(lines) + "\n"


def quoted(text: str) -> str:
    """Return text as a TOML basic string."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def comment(text: str) -> list[str]:
    """Return text as comment lines; control characters cannot break out of them."""
    clean = ["".join(sign if sign.isprintable() else " " for sign in line) for line in text.splitlines()]
    return [f"# {line}" for line in clean]


def _rig_line(draft: Draft) -> str:
    if draft.rig != TODO:
        return f"rig = {quoted(draft.rig)}  # its sensors fit the logs best"
    found = f"one of {', '.join(draft.rigs)}" if draft.rigs else "no rig file was found; name one of rigs/"
    return f'rig = "{TODO}"  # {comment(found)[0][2:]}'


def _modes(draft: Draft) -> str:
    if not draft.modes:
        return "a platform mode of the rig"
    return f"the rig has {', '.join(draft.modes)}"


def _log(log: DraftLog) -> list[str]:
    lines = [
        "[[log]]",
        f"file = {quoted(log.file)}  # {log.format}",
        f"clock = {quoted(log.clock)}  # {log.why}; logs that share a clock name the same",
    ]
    if log.problem:
        lines += comment(f"TODO: the reader says: {log.problem}")
        lines += comment(f"fix: {log.remedy}") if log.remedy else []
        lines += ["# settings of a log, where they answer that:", *(f"# {setting}" for setting in SETTINGS)]
        return lines
    found = log.matched
    if found.same:
        lines += comment(f"named as in the rig: {', '.join(found.same)}")
    if found.peaks:
        lines += comment(f"{found.peaks} numbered peaks find their gratings by wavelength")
    if found.guessed:
        pairs = ", ".join(f"{quoted(name)} = {quoted(sensor)}" for name, sensor in found.guessed.items())
        lines.append(f"channels = {{ {pairs} }}  # guessed by name: check")
    if found.unknown:
        lines += comment(f"of no sensor, not used unless named in channels: {', '.join(found.unknown)}")
    if found.no_unit:
        units = ", ".join(f'{quoted(name)} = "{TODO}"' for name in found.no_unit)
        lines.append(f"units = {{ {units} }}  # the file has none")
    return lines
