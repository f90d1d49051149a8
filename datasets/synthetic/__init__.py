"""Parts of the synthetic campaign: the truth, the instruments and the files they write."""
