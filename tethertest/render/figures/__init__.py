"""Figures of the page, one family a file; drawn without matplotlib's global state."""
