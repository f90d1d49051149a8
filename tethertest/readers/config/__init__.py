"""Run, rig, prototype and scene files into records, with errors that name file, line and key."""
