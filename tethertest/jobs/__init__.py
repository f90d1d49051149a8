"""One function per job; the only modules that know the order of things."""
