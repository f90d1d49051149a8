"""The table of what inspect says of a folder of logs."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from reports.inspected_samples.__main__ import main
from reports.inspected_samples.page import BY_HAND, page, rows_of


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Logs: good, ambiguous, jittered; and a hidden file."""
    logs = tmp_path / "logs"
    (logs / "inner").mkdir(parents=True)
    even = "".join(f"{row / 100:.2f},{row % 7},{row % 5}\n" for row in range(100))
    (logs / "good.csv").write_text(f"t [s],F_top [kN],a|b\n{even}", encoding="utf-8")
    dates = "".join(f"05/09/2026 10:00:{row:02d},{row % 7}\n" for row in range(30))
    (logs / "inner" / "open.csv").write_text(f"time,F\n{dates}", encoding="utf-8")
    kept = [row for row in range(400) if row**2 % 397 > 158]  # as good as by chance
    uneven = "".join(f"{row / 100:.2f},{row % 7}\n" for row in kept)
    (logs / "uneven.csv").write_text(f"t [s],F [N]\n{uneven}", encoding="utf-8")
    (logs / ".hidden").write_text("no log", encoding="utf-8")
    return logs


def test_a_row_tells_format_rows_channels_rate_span_and_units(folder: Path) -> None:
    rows = {row[0]: row for row in rows_of(folder)}
    assert [*rows] == ["good.csv", "inner/open.csv", "uneven.csv"]
    assert rows["good.csv"][1:7] == (
        "delimited, ascii", "100", "2", "100 Hz", "0.99 s", "kN → N (1), none (1)",
    )  # fmt: skip
    assert "every 10 ms, even" in rows["good.csv"][7]
    assert "looked for and not found: stuck, saturated, spike" in rows["good.csv"][7]


def test_a_rate_that_the_mean_denies_has_the_mean_beside_it(folder: Path) -> None:
    (row,) = (row for row in rows_of(folder) if row[0] == "uneven.csv")
    assert row[4] == "100 Hz, mean 62.26 Hz"
    assert "jittered: 96 of 231 steps (41.6 %) are not that, but 20 ms to 70 ms" in row[7]


def test_a_refusal_has_its_line_and_remedy_and_no_path_of_the_machine(folder: Path) -> None:
    (row,) = (row for row in rows_of(folder) if row[0] == "inner/open.csv")
    assert row[1:7] == ("delimited", "", "", "", "", "")
    assert row[7].startswith("refused: line 2: the date 5/9/... can be read as day/month")
    assert "Fix: set date_order" in row[7]
    assert str(folder) not in page(folder)


def test_a_file_in_an_archive_is_named_without_the_path_of_the_machine(folder: Path) -> None:
    with zipfile.ZipFile(folder / "two.zip", "w") as archive:
        archive.write(folder / "inner" / "open.csv", "open.csv")
        archive.write(folder / "good.csv", "good.csv")
    rows = {row[0]: row for row in rows_of(folder, [("two.zip", "table=open.csv")])}
    said = rows["two.zip --set table=open.csv"][7]
    assert said.startswith("refused: line 2: two.zip:open.csv: the date 5/9/... can be read")


def test_a_setting_adds_a_row(folder: Path) -> None:
    rows = rows_of(folder, [("inner/open.csv", "date_order=mdy")])
    assert [row[0] for row in rows][1:3] == ["inner/open.csv", "inner/open.csv --set date_order=mdy"]
    assert rows[2][2] == "30"


def test_every_row_of_the_page_has_all_cells(folder: Path) -> None:
    (folder / "bar.csv").write_text(
        "t [s],a|b\n" + "".join(f"{row},{row % 3}\n" for row in range(40)), "utf-8"
    )
    (folder / "bar.csv").rename(folder / "a|b.csv")
    table = [line for line in page(folder).splitlines() if line.startswith("|")]
    assert {line.replace("\\|", "").count("|") for line in table} == {9}
    assert "4 readings, 1 of them refused" in page(folder)


def test_what_is_written_by_hand_is_kept(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "README.md"
    assert main([str(folder), "-o", str(tmp_path)]) == 0
    text = output.read_text(encoding="utf-8")
    assert capsys.readouterr().out == text
    output.write_text(f"{text}\n{BY_HAND}\n## Where they are from\n", encoding="utf-8")
    (folder / "uneven.csv").unlink()
    main([str(folder), "-o", str(tmp_path)])
    again = output.read_text(encoding="utf-8")
    assert again.endswith(f"\n{BY_HAND}\n## Where they are from\n")
    assert "uneven.csv" not in again
    assert again.count(BY_HAND) == 1
