"""Flags of samples: stuck and saturated, spikes, steps, hum, limits, what no cable does."""
