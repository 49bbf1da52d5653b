"""A validation for readers: as text, for notebooks, and as plain data."""
