"""What cannot be at rest is refused, with what would mend it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tethertest.errors import DataError
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.statics.equilibrium import rest_chain

TETHER = Cable(144.0, "unstretched", 0.048, axial_stiffness=410020.0, diameter=0.006)
UAV = Top("platform", mass=5.0)
BREEZE = Air(density=1.225, normal_drag=1.2, tangential_drag=0.01, wind=10.0)
ENDS = Geometry("ends", top=(110.0, 90.0))


def scene(geometry: Geometry, top: Top = UAV, cable: Cable = TETHER, air: Air | None = None) -> Scene:
    return Scene("refused", cable, geometry, Bottom("fixed"), top, Output(1.0, 10.0, (0.0,)), air=air)


REFUSED = {
    "lift below the weight": (
        scene(Geometry("hovering"), replace(UAV, lift=100.0)),
        r"leaves 50\.97 N upwards.*weighs 67\.78 N.*raise \[top\] lift by more than 16\.82 N",
    ),
    "static tension below the cable's weight": (
        scene(Geometry("hovering"), replace(UAV, static_tension=50.0)),
        r"cannot be taut.*raise \[top\] static_tension by more than 17\.78 N",
    ),
    "vertical with too little static tension": (
        scene(Geometry("vertical"), replace(UAV, static_tension=50.0)),
        "raise the lift or the static tension above the weight",
    ),
    "wind on the body above the static tension": (
        scene(Geometry("hovering"), replace(UAV, static_tension=100.0, drag_area=(3.0, 0.1)), air=BREEZE),
        "wind pushes the platform with 183.8 N.*raise",
    ),
    "ends out of reach": (
        scene(Geometry("ends", top=(900.0, 90.0))),
        "ends lie 904.489 m apart.*lengthen",
    ),
    "strain beyond reason": (
        scene(Geometry("ends", top=(300.0, 350.0)), cable=replace(TETHER, axial_stiffness=100.0)),
        "ends lie .* m apart|strained by",
    ),
    "rest length below the distance": (
        scene(Geometry("ends", top=(300.0, 90.0)), cable=replace(TETHER, length_state="equilibrium")),
        "144 m long at rest.*above the distance",
    ),
    "slack upright cable": (
        scene(Geometry("ends", top=(0.0, 100.0))),
        "fold.*shorten",
    ),
    "two tensions at odds": (
        scene(Geometry("vertical", tension=20.0), replace(UAV, static_tension=100.0)),
        r"\[geometry\] tension says 20 N.*static_tension says 32.* N.*give one of the two",
    ),
    "tension and lift at odds": (
        scene(Geometry("vertical", tension=20.0), replace(UAV, lift=200.0)),
        r"\[geometry\] tension says 20 N.*\[top\] lift says 83.* N",
    ),
    "both lift and static tension": (
        scene(Geometry("hovering"), replace(UAV, static_tension=100.0, lift=160.0)),
        "both lift and static_tension",
    ),
    "both lift and static tension between ends": (
        scene(ENDS, replace(UAV, static_tension=100.0, lift=160.0)),
        "both lift and static_tension",
    ),
    "sideways lift over a vertical cable": (
        scene(Geometry("vertical"), replace(UAV, lift=(5.0, 160.0))),
        'give a vertical .top. lift, or set .geometry. kind = "hovering"',
    ),
    "static tension that does not hold at the top": (
        scene(ENDS, replace(UAV, static_tension=100.0)),
        'pulls with 118.* N at the top.*static_tension says 100 N.*write "118',
    ),
    "lift that does not hold at the top": (
        scene(ENDS, replace(UAV, lift=100.0)),
        r'does not hold the platform.*write \["70\.98.* N", "0 N", "143\.5.* N"\]',
    ),
    "no top": (scene(Geometry("ends")), r"no upper end.*give \[geometry\] top"),
    "no tension": (scene(Geometry("shallow"), Top("fixed")), r"no tension.*give \[geometry\] tension"),
    "no lift": (scene(Geometry("hovering")), "neither lift nor static_tension.*give one of the two"),
    "fixed hovering": (scene(Geometry("hovering"), Top("fixed")), 'fixed top.*kind = "platform"'),
    "storm that folds the cable": (
        scene(
            Geometry("hovering"),
            replace(UAV, static_tension=70.0),
            cable=replace(TETHER, diameter=0.03),
            air=replace(BREEZE, wind=(0.0, 0.0, -40.0)),
        ),
        "fold.*(wind|tension)",
    ),
    "stiffness that pushes the ends apart": (
        scene(Geometry("ends", top=(50.0, 0.0)), cable=replace(TETHER, bending_stiffness=1e6)),
        "push part of the cable together.*lower .cable. bending_stiffness",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_scene_without_rest_is_refused_with_its_remedy(name: str) -> None:
    refused, words = REFUSED[name]
    with pytest.raises(DataError, match=f"(?s){words}"):
        rest_chain(refused, 40)


def test_chain_of_one_cell_is_refused() -> None:
    with pytest.raises(DataError, match="1 cells, expected at least 2"):
        rest_chain(scene(ENDS), 1)
