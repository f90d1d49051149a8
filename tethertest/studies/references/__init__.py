"""Solutions by schemes of another kind than the production march, to measure its error with."""
