"""Natural frequencies and shapes about rest."""
