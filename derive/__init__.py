"""Equations of optimal estimation, each with a proof that a machine can replay.

The lectures are modules, loaded when they are first used:

>>> import derive
>>> lecture = derive.observer.lecture()
>>> all(outcome.accepted for outcome in lecture.verify())
True
"""

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

from derive._version import __version__
from derive.errors import InputError

if TYPE_CHECKING:
    from derive import notes
    from derive.check import check
    from derive.theory import covariance, duality, kalman_bucy, luenberger, observer

__all__ = [
    "InputError",
    "__version__",
    "check",
    "covariance",
    "duality",
    "kalman_bucy",
    "luenberger",
    "notes",
    "observer",
]

_LATER = {
    "check": "derive.check",
    "notes": "derive.notes",
    **{name: f"derive.theory.{name}" for name in ("observer", "covariance", "luenberger", "kalman_bucy", "duality")},
}


def __getattr__(name: str) -> ModuleType:
    if name in _LATER:
        return import_module(_LATER[name])
    raise AttributeError(f"module 'derive' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
