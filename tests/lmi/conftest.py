"""Plants for the tests of the convex programs."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from derive.numeric.plant import Plant, plant_from_mapping

TIMES = ("continuous", "discrete")


@pytest.fixture
def random_plant() -> Callable[..., Plant]:
    """A seeded plant with correlated noises; unstable for about half of the seeds; odd n have a weight M."""

    def make(time: str, n: int, seed: int = 0) -> Plant:
        rng = np.random.default_rng([seed, n, TIMES.index(time)])
        l = 1 + n // 3  # noqa: E741
        A = rng.standard_normal((n, n)) / np.sqrt(n) * (1.1 if time == "discrete" else 1.0)
        G = rng.standard_normal((n + l, n + l)) / np.sqrt(n + l)
        noise = G @ G.T + np.diag(np.r_[np.zeros(n), np.full(l, 0.3)])
        E = rng.standard_normal((n, n))
        data: dict[str, Any] = {
            "time": time,
            "A": A,
            "C": rng.standard_normal((l, n)),
            "W": noise[:n, :n],
            "N": noise[:n, n:],
            "V": noise[n:, n:],
        }
        if n % 2:
            data["M"] = E @ E.T + 0.1 * np.eye(n)
        return plant_from_mapping(data)

    return make
