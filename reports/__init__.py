"""Proofs of the tool: each package makes the tables and figures that stand beside it."""
