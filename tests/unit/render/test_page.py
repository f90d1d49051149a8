import re
from dataclasses import replace

import numpy as np
import pytest

from tests.unit.render.fake_report import bare_report, fake_report
from tethertest.records.channel import Flag
from tethertest.records.comparison import Comparison, Verdict
from tethertest.records.response import Field
from tethertest.records.run import Drive
from tethertest.render.page import page


@pytest.fixture(scope="module")
def full():
    return page(fake_report(verdict=Verdict.FAIL))


def headings(text):
    return re.findall(r"<h2>(.*?)</h2>", text)


def test_the_same_report_gives_the_same_page(full):
    assert page(fake_report(verdict=Verdict.FAIL)) == full


def test_the_page_needs_nothing_from_elsewhere(full):
    assert not re.findall(r"(?:src|href)=\"(?!data:|#)", full)
    assert "<script" not in full
    assert "default-src 'none'" in full


def test_the_verdict_and_its_reasons_come_first(full):
    assert full.index("FAIL") < full.index("0.7 % too much") < full.index("<img") < full.index("<h2>")


def test_every_figure_is_described(full):
    images = re.findall(r"<img [^>]*>", full)
    assert len(images) == 6
    assert all(re.search(r'alt="[^"]{20,}"', image) for image in images)


def test_strain_is_shown_in_microstrain_and_clocks_in_milliseconds(full):
    assert re.search(r"fbg1.{0,200}\d µε", full, re.DOTALL)  # noise of a sample
    assert "Strains, for information" in full
    assert "1370.20 ± 0.80" in full
    assert "41.3 ± 6.1" in full


def test_text_from_files_is_never_markup():
    report = fake_report()
    nasty = '<script>alert("x")</script> $\\frac$ 张'
    file = replace(report.run.file, title=nasty, operator=nasty)
    text = page(replace(report, run=replace(report.run, file=file)))
    assert "<script" not in text
    assert "&lt;script&gt;" in text


def test_sensor_names_may_hold_dollars_and_characters_the_font_lacks():
    report = fake_report()
    name = "张$力$_{top"
    sensors = tuple(
        replace(sensor, name=name) if sensor.name == "fbg3" else sensor for sensor in report.run.rig.sensor
    )
    rig = replace(report.run.rig, sensor=sensors)
    channels = tuple(
        replace(channel, name=name) if channel.name == "fbg3" else channel
        for channel in report.measured.channels
    )
    changed = replace(
        report, run=replace(report.run, rig=rig), measured=replace(report.measured, channels=channels)
    )
    assert name in page(changed)


def test_a_run_with_nothing_in_it_says_why_piece_by_piece():
    text = page(bare_report())
    assert headings(text) == headings(page(fake_report()))
    assert "<img" not in text
    for sentence in (
        "No overlay of tension_top",
        "No usable sample, and nothing was replayed there: fbg5, fbg4, fbg3, fbg2, fbg1.",
        "No spectra",
        "Nothing was replayed, so there is no tension along the cable to show.",
        "No similitude",
        "No metrics",
        "no drive was found",
    ):
        assert sentence in text


def test_a_channel_that_is_all_lost_leaves_the_replay_alone():
    report = fake_report()
    channels = tuple(
        replace(
            channel,
            values=np.full(channel.time.shape, np.nan),
            flags=np.full(channel.time.shape, Flag.LOST, np.uint16),
        )
        if channel.name in {"fbg2", "tension_top"}
        else channel
        for channel in report.measured.channels
    )
    text = page(replace(report, measured=replace(report.measured, channels=channels)))
    assert "lost 8943 (100 %)" in text


def test_measured_channels_without_a_replay_are_shown():
    report = replace(fake_report(), response=None, replayed=(), replayed_lines=(), replayed_events=())
    text = page(report)
    assert text.count("<img") == 4
    assert "Time series of measured tension at tension_top" in text


def test_a_rig_without_load_cells_or_gratings_gets_sentences():
    report = fake_report()
    rig = replace(report.run.rig, sensor=())
    text = page(replace(report, run=replace(report.run, rig=rig)))
    assert "the rig file has no load cell" in text
    assert "no strain grating" in text


def test_more_reasons_than_fit_lead_to_the_rest():
    report = fake_report()
    many = tuple(f"reason {i}" for i in range(9))
    text = page(replace(report, comparison=Comparison((), Verdict.FAIL, many)))
    assert "and 5 more" in text
    assert "reason 8" in text


def test_a_quiet_run_without_a_drive_is_shown():
    report = fake_report()
    file = replace(report.run.file, drive=Drive("none"))
    quiet = replace(
        report,
        run=replace(report.run, file=file),
        drive=None,
        measured=replace(report.measured, steady=None),
        measured_lines=(),
        replayed_lines=(),
        events=(),
        replayed_events=(),
    )
    text = page(quiet)
    assert text.count("<img") == 6
    assert "the cable was taut throughout" in text
    assert "No lines of tension_top" in text


def test_without_axial_stiffness_the_gratings_are_left_out_and_it_says_so():
    report = fake_report()
    assert report.response is not None
    scene = report.response.scene
    cable = replace(scene.cable, axial_stiffness=None)
    response = replace(report.response, scene=replace(scene, cable=cable))
    assert "does not give the axial stiffness" in page(replace(report, response=response))


def test_a_replay_of_one_bin_and_one_sample_is_drawn():
    report = fake_report()
    assert report.response is not None
    field = Field(np.zeros(1), np.zeros(1), np.ones((1, 1)), np.ones((1, 1)))
    measured = tuple(channel.between(0.0, 0.001) for channel in report.measured.channels)
    text = page(
        replace(
            report,
            response=replace(report.response, field=field),
            measured=replace(report.measured, channels=measured),
            replayed=(),
        )
    )
    assert "No spectra: no channel could be used." in text
