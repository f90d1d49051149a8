"""Speed against error on the shipped scenes, the stated figures, and MoorDyn beside them."""
