"""Lecture notes: one document model and its writers."""
