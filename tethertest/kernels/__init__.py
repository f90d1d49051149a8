"""Compiled loops: floats and arrays in, arrays filled; numpy and numba only."""
