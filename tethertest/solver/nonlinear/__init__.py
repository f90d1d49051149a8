"""The geometrically exact cable, taut or slack, marched on its material mesh."""
