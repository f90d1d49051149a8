"""``python -m tethertest.cli``."""

from tethertest.cli import main

main()
