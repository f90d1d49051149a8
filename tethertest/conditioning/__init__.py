"""From logs on any clock to calibrated, tared, flagged channels on one clock."""

from tethertest.conditioning.condition import condition
from tethertest.conditioning.guide import Guide
from tethertest.conditioning.stated import drive_findings, stated_findings

__all__ = ["Guide", "condition", "drive_findings", "stated_findings"]
