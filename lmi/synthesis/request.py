"""What is asked of a gain."""

from dataclasses import dataclass, replace
from typing import Any, Literal, cast

from derive.errors import InputError
from derive.numeric.fields import read_number, show
from lmi.synthesis.achieved import Achieved

__all__ = ["Objective", "Request"]

Objective = Literal["h2", "hinf"]


@dataclass(frozen=True)
class Request:
    """An objective and bounds.

    Attributes:
        objective: "h2", the least tr(M P); or "hinf", the smallest H-infinity norm from noise to M^(1/2) e.
        gamma: with "hinf", a norm that suffices, so that it need not be the smallest; or None.
        decay: every mode falls at least at this rate [1/s], in discrete time |lambda| <= exp(-decay dt); or None.
        dual: whether the gain is one of state feedback for the transposed plant.
    """

    objective: Objective
    gamma: float | None = None
    decay: float | None = None
    dual: bool = False

    @classmethod
    def of(cls, objective: Any, gamma: Any, decay: Any, dual: bool) -> "Request":
        """Check a request.

        Raises:
            InputError: with one line that says what was expected, what was got and the remedy.
        """
        if objective not in ("h2", "hinf"):
            raise InputError(f'objective: expected "h2" or "hinf", got {show(objective)}; choose one')
        if gamma is not None and objective == "h2":
            raise InputError(
                "gamma: expected with the objective hinf, got it with h2; "
                "hinf with gamma returns a gain with a small H2 norm among those that reach gamma"
            )
        gamma, decay = _positive("gamma", gamma), _positive("decay", decay)
        return cls(cast(Objective, objective), gamma, decay, bool(dual))

    def is_met(self, found: Achieved) -> bool:
        """Tell whether the decay and gamma are reached."""
        decays = self.decay is None or found.decay >= self.decay
        return decays and (self.gamma is None or found.hinf.upper <= self.gamma)

    def stricter(self, share: float) -> "Request":
        """Return the request with bounds that are harder to meet by a share."""
        gamma = None if self.gamma is None else self.gamma * (1 - share)
        return replace(self, gamma=gamma, decay=None if self.decay is None else self.decay * (1 + share))


def _positive(name: str, value: Any) -> float | None:
    if value is None:
        return None
    number = read_number(name, value)
    if number <= 0:
        raise InputError(f"{name}: expected a positive number, got {number:g}; leave it out for no bound")
    return number
