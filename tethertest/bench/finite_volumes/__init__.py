"""A reference for axial waves, taut or slack: second-order finite volumes."""
