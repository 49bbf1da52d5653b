"""`python -m lmi` is the command line."""

from lmi.cli import main

main()
