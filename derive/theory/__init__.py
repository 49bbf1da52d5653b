"""Lectures: each displayed equation derived, with its certificate."""
