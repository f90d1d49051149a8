"""Conditioning of a log that is larger than memory.

The columns go to scratch files once. What needs the whole record (stamps, noise, plateaus) is gathered block
by block; clocks and windows are found on a thinned copy by the ordinary conditioning; zeros and hum come from
the rest windows at the full rate. Then every block is calibrated, flagged, put on the run's clock, tared and
written.
"""
