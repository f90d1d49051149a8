"""Load cells: calibration, and zeros from the rest windows."""
