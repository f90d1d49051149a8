import errno
from pathlib import Path

import pytest

from tests.unit.render.fake_report import bare_report
from tethertest.errors import TethertestError
from tethertest.render import write_report
from tethertest.render.write import write_files


def test_page_and_summary_are_written_into_a_new_folder(tmp_path):
    folder = tmp_path / "reports" / "run07"
    assert write_report(bare_report(), folder) == (folder / "report.html", folder / "summary.json")
    assert sorted(path.name for path in folder.iterdir()) == ["report.html", "summary.json"]


@pytest.mark.parametrize("below", ["", "deeper"])
def test_a_file_in_the_way_is_named_with_a_remedy(tmp_path, below):
    blocker = tmp_path / "reports"
    blocker.write_text("not a folder")
    with pytest.raises(TethertestError, match="a file stands where") as caught:
        write_files(blocker / below, {"report.html": b"page"})
    assert str(blocker) in str(caught.value.path)
    assert "choose another output folder" in caught.value.remedy
    assert blocker.read_text() == "not a folder"


def test_a_folder_in_a_files_place_stops_everything(tmp_path):
    (tmp_path / "summary.json").mkdir()
    with pytest.raises(TethertestError, match="a folder stands where"):
        write_files(tmp_path, {"report.html": b"page", "summary.json": b"{}"})
    assert [path.name for path in tmp_path.iterdir()] == ["summary.json"]


def test_a_folder_without_permission_is_an_error_with_a_remedy(tmp_path, monkeypatch):
    def refuse(path, *_, **__):
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(TethertestError, match="Permission denied") as caught:
        write_files(tmp_path / "new", {"report.html": b"page"})
    assert "permissions" in caught.value.remedy


def test_a_full_disk_leaves_the_older_report_as_it_was(tmp_path, monkeypatch):
    (tmp_path / "report.html").write_bytes(b"older")
    genuine = Path.write_bytes

    def fills_up(path, data):
        if "summary" in path.name:
            genuine(path, data[:1])
            raise OSError(errno.ENOSPC, "No space left on device")
        return genuine(path, data)

    monkeypatch.setattr(Path, "write_bytes", fills_up)
    with pytest.raises(TethertestError, match="No space left"):
        write_files(tmp_path, {"report.html": b"newer", "summary.json": b"{}"})
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]
    assert (tmp_path / "report.html").read_bytes() == b"older"
