"""A reference for taut cables in a plane or in space: spectral elements of degree 8."""
