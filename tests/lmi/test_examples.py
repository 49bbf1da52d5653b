"""Every example in a docstring of the convex programs runs and gives what it shows."""

import doctest
from importlib import import_module
from pkgutil import walk_packages

import pytest

import lmi

MODULES = [name for _, name, _ in walk_packages(lmi.__path__, "lmi.") if name != "lmi.__main__"]


@pytest.mark.parametrize("name", ["lmi", *MODULES])
def test_examples_of_a_module(name):
    assert doctest.testmod(import_module(name)).failed == 0


def test_the_programs_have_examples():
    finder = doctest.DocTestFinder()
    for name in ("lmi.programs.h2", "lmi.programs.optimal_covariance", "lmi.covariance", "lmi.validation"):
        assert any(test.examples for test in finder.find(import_module(name)))
