"""The parts of the page, each from the report to blocks."""
