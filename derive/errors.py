"""Errors that a user of this package can cause; each message says what was expected, what was got and the remedy."""

__all__ = ["InputError"]


class InputError(ValueError):
    """Bad input: a plant, claim, file or option that cannot be used as given (exit code 2 on the command line)."""
