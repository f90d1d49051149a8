"""The cable about its rest: the exact transform and the characteristics of the linear equations."""
