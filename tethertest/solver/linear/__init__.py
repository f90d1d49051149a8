"""The cable about its rest: exact waves and transforms, which `auto` picks, and two schemes it never picks.

`two_grid`, characteristics on two grids, checks the exact transform; `as_printed` is the source article's own
scheme and converges to the wrong equations. Both answer to their names alone.
"""
