"""Parts of `check_lines.py`: what the analysis finds of events, held against truth.json."""
