"""How often the line search is wrong, on records with known content: false alarms, power, bias, coverage."""
