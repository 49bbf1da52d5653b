"""One convex program a file."""
