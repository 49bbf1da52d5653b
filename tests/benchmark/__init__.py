"""Speed and counts against their targets: python -m tests.benchmark [--only SECTION]."""
