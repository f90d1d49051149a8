"""Damaged logs of every format, and what became of them."""
