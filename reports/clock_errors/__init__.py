"""How far fitted clocks are off on random synthetic runs, against what they state and against the bound."""
