"""Text logs: bytes, encoding, layout, columns, stamps."""
