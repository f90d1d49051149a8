"""A real ingest, killed at random instants and starved of disk."""
