"""Long, stiff, light, heavy and slack runs, each against what was asked of it."""
