"""Experiment-data analysis and similitude for ship-borne tethered UAVs."""

__version__ = "0.1.0"
