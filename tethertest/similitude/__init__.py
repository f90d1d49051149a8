"""Pi groups, scale ratios and distortion between a model and its prototype, in exact algebra."""

from tethertest.similitude.conflicts import conflicts
from tethertest.similitude.demands import Demand, kept, same, scaled
from tethertest.similitude.distortion import level
from tethertest.similitude.groups import Diagnosis, diagnose, dimensions_of, formula, pi_groups, value_of
from tethertest.similitude.laws import LAWS, Law
from tethertest.similitude.scales import Scales, scale_ratios
from tethertest.similitude.sets import (
    PAPER_GROUPS,
    PAPER_REPEATING,
    PAPER_VARIABLES,
    TETHER_GROUPS,
    NamedGroup,
)
from tethertest.similitude.similarity import similarity
from tethertest.similitude.variables import Motion, tether_variables

__all__ = [
    "LAWS",
    "PAPER_GROUPS",
    "PAPER_REPEATING",
    "PAPER_VARIABLES",
    "TETHER_GROUPS",
    "Demand",
    "Diagnosis",
    "Law",
    "Motion",
    "NamedGroup",
    "Scales",
    "conflicts",
    "diagnose",
    "dimensions_of",
    "formula",
    "kept",
    "level",
    "pi_groups",
    "same",
    "scale_ratios",
    "scaled",
    "similarity",
    "tether_variables",
    "value_of",
]
