"""Waves up and down the source article's cable, their energy, and where its tension is largest."""
