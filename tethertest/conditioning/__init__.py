"""From logs on any clock to calibrated, tared, flagged channels on one clock."""

from tethertest.conditioning.condition import condition
from tethertest.conditioning.guide import Guide
from tethertest.conditioning.stated import stated_findings

__all__ = ["Guide", "condition", "stated_findings"]
