"""The measured series that a scene file names."""
