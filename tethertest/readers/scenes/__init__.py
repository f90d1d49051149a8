"""The parts of a scene file, and the measured series it names."""
