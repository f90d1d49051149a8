"""Measured against replayed: metrics with uncertainties, limits, verdict."""

from tethertest.compare.decision import Uncertainty, decide
from tethertest.compare.orders import OrderError, order_error
from tethertest.compare.runs import compare
from tethertest.compare.sprague_geers import SpragueGeers, sprague_geers

__all__ = ["OrderError", "SpragueGeers", "Uncertainty", "compare", "decide", "order_error", "sprague_geers"]
