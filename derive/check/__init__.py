r"""The checker: formulas of documents, or as they stand, each proved, refuted, supported or undecided.

``derive.check`` is this module and can be called:

>>> import derive
>>> report = derive.check(r"L = P C^\top (C P C^\top + R)^{-1}", theory="luenberger-dt")
>>> report.results[0].verdict, report.exit_code
('refuted', 1)
"""

import sys
from types import ModuleType
from typing import Any

from derive.check.result import Report, Result
from derive.check.run import check

__all__ = ["Report", "Result", "check"]


class _Callable(ModuleType):
    """A module whose call is that of its function of the same name."""

    def __call__(self, *args: Any, **kwargs: Any) -> Report:
        return check(*args, **kwargs)


sys.modules[__name__].__class__ = _Callable
