"""What a hostile or damaged file must pass before a library sees it."""
