"""What a user measures on scenes of his own: speed against error, by references of another kind."""
