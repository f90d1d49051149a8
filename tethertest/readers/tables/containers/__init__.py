"""What formats that hold tables share: limits, archives, candidates, the mapping of run.toml."""
