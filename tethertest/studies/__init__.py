"""Studies of the tool itself: references of another kind, speed against error, stability batteries."""
