"""Theories as claims are read in them, by key."""
