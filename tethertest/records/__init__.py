"""Frozen records in SI: what the packages hand to each other."""
