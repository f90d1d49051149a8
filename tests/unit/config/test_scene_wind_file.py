"""The wind file of a scene: its columns, units, and what is refused."""

import numpy as np
import pytest

from tethertest.errors import TethertestError
from tethertest.readers import load_scene
from tethertest.readers.config.scene_series import read_wind

TIME = np.arange(81) * 0.5
GUST = 8.0 + 3.0 * np.sin(0.3 * TIME)


@pytest.fixture
def blown(bench):
    """Return what writes the wind file, names it in the scene, and reads it."""

    def read(names, *columns):
        bench.spoil(
            bench.scene, "[output]", '[air]\ndensity = "1.2 kg/m^3"\nwind_file = "gust.csv"\n[output]'
        )
        rows = [
            ",".join(f"{v:.9g}" if np.isfinite(v) else "" for v in row) for row in np.column_stack(columns)
        ]
        bench.scene.with_name("gust.csv").write_text("\n".join([names, *rows, ""]), encoding="utf-8")
        return read_wind(load_scene(bench.scene))

    return read


@pytest.mark.parametrize(
    ("names", "factor"),
    [
        ("time_s,wind_x_m_s,wind_z_m_s", 1.0),
        ("t,wind_x,wind_z", 1.0),
        ("time [s],u [m/s],w [m/s]", 1.0),
        ("time_s,wind_x_km_h,wind_z_km_h", 3.6),
        ("time_s,wind_x [knot],wind_z [knot]", 3600.0 / 1852.0),
    ],
)
def test_components_are_found_by_name_in_their_units_and_a_missing_one_is_zero(blown, names, factor):
    wind = blown(names, TIME, GUST * factor, -factor * TIME)
    assert wind.time == pytest.approx(TIME)
    assert wind.velocity[:, 0] == pytest.approx(GUST, rel=1e-6)
    assert not wind.velocity[:, 1].any()
    assert wind.velocity[:, 2] == pytest.approx(-TIME, rel=1e-6)


def test_other_columns_are_left_out(blown):
    assert blown("time_s,temperature,wind_y_m_s", TIME, GUST, GUST).velocity[:, 1] == pytest.approx(GUST)


def test_a_scene_without_a_wind_file_has_no_series(bench):
    assert read_wind(load_scene(bench.scene)) is None


HOLED = np.where(np.arange(81) >= 40, TIME + 10.0, TIME)
REFUSED = {
    "no time": ("clock,wind_x_m_s", (TIME, GUST), "no time column among clock, wind_x_m_s"),
    "no component": ("time_s,temperature", (TIME, GUST), "no component of the wind among"),
    "misspelled": ("time_s,wind_x_m_s,wnd_z_m_s", (TIME, GUST, GUST), "did you mean wind_z_m_s"),
    "one twice": ("time_s,wind_x_m_s,u", (TIME, GUST, GUST), "'wind_x_m_s' and 'u' give the same component"),
    "hole": ("time_s,wind_x_m_s", (HOLED, GUST), r"gust\.csv:42: found a hole of 10\.5 s"),
    "blank": ("time_s,wind_x_m_s", (TIME, np.where(TIME == 3.0, np.nan, GUST)), r"gust\.csv:8: .*no number"),
    "unsorted": ("time_s,wind_x_m_s", (np.where(TIME == 3.0, 1.0, TIME), GUST), r"gust\.csv:8: .*backward"),
    "too short": ("time_s,wind_x_m_s", (TIME[:60], GUST[:60]), r"ends 29\.5 s after .*expected 40 s"),
    "other unit": ("time_s,wind_x [N]", (TIME, GUST), "expected one of velocity"),
}  # fmt: skip


@pytest.mark.parametrize(("names", "columns", "message"), REFUSED.values(), ids=REFUSED)
def test_a_wind_that_cannot_be_used_is_refused_with_its_remedy(blown, names, columns, message):
    with pytest.raises(TethertestError, match=message) as caught:
        blown(names, *columns)
    assert "\n  fix: " in str(caught.value)
