"""From logs on any clock to calibrated, tared, flagged channels on one clock."""

from tethertest.conditioning.condition import condition
from tethertest.conditioning.rig_priors import RigPriors
from tethertest.conditioning.stated import stated_findings

__all__ = ["RigPriors", "condition", "stated_findings"]
