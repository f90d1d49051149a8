"""Conditioned channels in the files of other programs, one format per module."""
