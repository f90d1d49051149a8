import json
from dataclasses import replace

from tests.unit.render.fake_report import DRIVE, bare_report, fake_report
from tethertest.records.comparison import Verdict
from tethertest.render.as_json import as_json, json_text
from tethertest.render.summary import summary


def said_by(report):
    return as_json(summary(report))


def text_of(report):
    return json_text(summary(report), indent=2, sort_keys=True)


def test_lines_have_the_shape_that_analyze_prints():
    lines = said_by(fake_report())["lines"]
    assert lines["drive"] == {"frequency": DRIVE, "standard_error": 4.2e-6}
    assert lines["window"] == [15.0, 82.0]
    top = lines["channels"][0]
    assert (top["name"], top["unit"]) == ("tension_top", "N")
    assert set(top["lines"][0]) == {
        "order",
        "frequency",
        "amplitude",
        "phase",
        "interval",
        "standard_error",
        "calibration_error",
        "p_value",
        "significant_above",
        "verdict",
        "reason",
    }
    assert next(line for line in top["lines"] if line["order"] == "1/2")["verdict"] == "not_resolvable"


def test_events_stand_with_their_channel_and_alone():
    said = said_by(fake_report())
    bottom = next(channel for channel in said["lines"]["channels"] if channel["name"] == "tension_bottom")
    assert bottom["events"] == said["events"]
    assert said["lines"]["channels"][0]["events"] == []
    assert {event["kind"] for event in said["events"]} == {"slack", "snap"}


def test_exponents_are_exact_fractions_as_text():
    groups = {group["name"]: group for group in said_by(fake_report())["similarity"]["groups"]}
    assert groups["axial wave"]["exponents"] == {"omega": "1", "L": "1", "rho_l": "1/2", "EA": "-1/2"}
    assert groups["sag"]["level"] == "violated"


def test_what_is_no_number_becomes_null():
    said = json.loads(text_of(fake_report()))
    top = said["lines"]["channels"][0]["lines"]
    assert next(line for line in top if line["order"] == "8")["p_value"] is None
    slack = next(metric for metric in said["metrics"] if metric["name"] == "slack_fraction")
    assert slack["uncertainty"] is None
    assert "NaN" not in text_of(fake_report())


def test_the_solver_is_told_without_its_wall_time():
    report = fake_report()
    assert report.response is not None
    later = replace(report, response=replace(report.response, wall=99.0))
    assert text_of(report) == text_of(later)
    assert said_by(report)["solver"]["slack"] == {"0": [[20.1, 20.3]]}


def test_a_run_with_nothing_in_it_still_says_why():
    said = said_by(bare_report())
    assert said["verdict"] == Verdict.UNDECIDED.value
    assert said["reasons"] == ["nothing can be decided: no usable clock"]
    assert said["similarity"] is None
    assert said["solver"] is None
    assert said["lines"] == {"drive": None, "window": None, "channels": []}
