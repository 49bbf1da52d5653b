"""Convex programs that reproduce the optimal error covariance."""

from derive._version import __version__

__all__ = ["__version__"]
