"""Every file in rigs/ loads, says what the article says, and matches its schema."""

from pathlib import Path

import pytest

from tethertest.cli.schemas import schema_of
from tethertest.readers import load_prototype, load_prototype_of, load_rig, load_scene
from tethertest.readers.config.toml import read_document

RIGS = Path(__file__).parents[3] / "rigs"
FILES = sorted(RIGS.rglob("*.toml"))

#: condition -> pretension [N], length [m], Young's modulus [Pa], diameter [m]: Table 1 of the article
TABLE_1 = {
    "1.1": (80, 250, 1.7e7, 3e-3),
    "1.2": (80, 200, 1.7e7, 3e-3),
    "1.3": (160, 250, 1.7e7, 3e-3),
    "1.4": (80, 250, 1.7e8, 3e-3),
    "1.5": (80, 250, 1.7e7, 12e-3),
}


def kind_of(path):
    if path.parent.name == "scenes":
        return "scene"
    return "prototype" if "prototype" in path.name else "rig"


def name_of(path):
    return path.relative_to(RIGS).as_posix()


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_every_shipped_file_loads(path):
    load = {"scene": load_scene, "rig": load_rig, "prototype": load_prototype}[kind_of(path)]
    assert load(path).name


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_schema_hint_points_to_the_schema_of_its_kind(path):
    first = path.read_text(encoding="utf-8").splitlines()[0]
    assert first.startswith("#:schema ")
    assert (path.parent / first.split()[1]).resolve() == RIGS / "schema" / f"{kind_of(path)}.schema.json"


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_every_shipped_key_is_in_the_schema(path):
    schema = schema_of(kind_of(path))

    def walk(here, node):
        node = schema["$defs"][node["$ref"].rsplit("/", 1)[1]] if "$ref" in node else node
        if isinstance(here, dict):
            properties = node.get("properties")
            for key, value in here.items():
                walk(value, node["additionalProperties"] if properties is None else properties[key])
            assert set(node.get("required", ())) <= here.keys()
        elif isinstance(here, list) and "items" in node:
            for entry in here:
                walk(entry, node["items"])
        elif "enum" in node:
            assert here in node["enum"]

    walk(read_document(path, "file").data, schema)


@pytest.mark.parametrize("kind", ["run", "rig", "prototype", "scene"])
def test_schema_forbids_unknown_keys_in_every_table(kind):
    schema = schema_of(kind)
    assert schema["$schema"].endswith("2020-12/schema")
    for table in (schema, *schema["$defs"].values()):
        assert table["additionalProperties"] is False
        assert table["description"]
    assert "uncertainty" not in schema["properties"]


def test_schema_describes_a_field_by_its_comment_and_unit():
    sensor = schema_of("rig")["$defs"]["Sensor"]["properties"]
    assert "fraction of the length from the bottom" in sensor["at"]["description"]
    assert "quantity in N" in sensor["rated"]["description"]


@pytest.mark.parametrize("condition", TABLE_1)
def test_scenes_are_the_articles_conditions(condition):
    scene = load_scene(RIGS / "scenes" / f"paper-{condition}.toml")
    cable = scene.cable
    assert (scene.geometry.tension, cable.length, cable.youngs_modulus, cable.diameter) == pytest.approx(
        TABLE_1[condition]
    )
    assert cable.mass_per_length == pytest.approx(0.02)


@pytest.mark.parametrize(("reading", "mass", "stiffness"), [("a", 0.0484, 10020.0), ("b", 0.048, 410020.0)])
def test_presets_are_the_two_readings_of_table_4(reading, mass, stiffness):
    path = RIGS / f"table4-reading-{reading}-rig.toml"
    rig = load_rig(path)
    prototype = load_prototype_of(rig, path)
    for cable in (rig.cable, prototype.cable):
        assert (cable.mass_per_length, cable.axial_stiffness) == pytest.approx((mass, stiffness))
    assert (rig.cable.length, prototype.cable.length) == (3.0, 150.0)
    assert (rig.platform.mass, prototype.platform.mass) == (0.4, 5.0)


def test_the_rig_and_its_prototype_are_reading_a():
    path = RIGS / "rig3m.toml"
    rig = load_rig(path)
    prototype = load_prototype_of(rig, path)
    assert rig.cable.axial_stiffness == prototype.cable.axial_stiffness == pytest.approx(10020.0)
    assert prototype.sea.frequency == pytest.approx((0.1, 0.3))
    assert prototype.sea.amplitude == pytest.approx((0.0, 5.0))


def test_uncertainties_are_standard_deviations_in_si_by_dotted_key():
    uncertainty = load_rig(RIGS / "rig3m.toml").uncertainty
    assert uncertainty["cable.length"] == pytest.approx(2e-3)
    assert uncertainty["cable.axial_stiffness"] == pytest.approx(100.0)
    assert uncertainty["platform.modes.soft.hover_stiffness"] == pytest.approx(0.4)
    assert uncertainty["sensor.tension_top.sensitivity"] == pytest.approx(2e-6)
    assert "cable.diameter" not in uncertainty
