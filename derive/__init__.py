"""Equations of optimal estimation, each with a proof that a machine can replay."""

from derive._version import __version__

__all__ = ["__version__"]
