"""Clocks: what two instruments saw alike, and offset and drift between them."""
