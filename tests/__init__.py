"""Tests, reference results and benchmarks."""
