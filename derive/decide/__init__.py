"""Decide claims: proved, refuted, supported or undecided, with the reason."""
