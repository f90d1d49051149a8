"""Does the stated error cover the true one: random scenes against references of another kind."""
