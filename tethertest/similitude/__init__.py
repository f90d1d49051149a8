"""similitude."""
