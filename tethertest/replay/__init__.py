"""A run becomes a scene; its response becomes channels at the sensors' places and times."""

from tethertest.replay.channels import expected_bottom_tension, member_channels, replayed_channels
from tethertest.replay.motion import BottomMotion, bottom_motion, motion_reach
from tethertest.replay.scene import rest_tensions, run_scene
from tethertest.replay.variations import Variation, variations

__all__ = [
    "BottomMotion",
    "Variation",
    "bottom_motion",
    "expected_bottom_tension",
    "member_channels",
    "motion_reach",
    "replayed_channels",
    "rest_tensions",
    "run_scene",
    "variations",
]
