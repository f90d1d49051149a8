"""Bytes into layout, rows and columns, and one search for their time: for text, sheets and trees alike."""
