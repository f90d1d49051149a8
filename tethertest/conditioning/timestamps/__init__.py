"""Stamps of a log: their steps, jumps and starts, and its columns as the rig's sensors."""
