"""The optimal covariance after the measurement, P+, as the largest that satisfies the Riccati inequality of the filter.

With F = A - S R^-1 C and Q~ = Q - S R^-1 S', in discrete time,

    max tr(M P+)  s.t.  [[P - P+, P C'], [C P, C P C' + R]] >= 0,  P = F P+ F' + Q~.

That is the predictor's program of another plant (F, C F, Q~, C Q~ C' + R) with cross term Q~ C': the filter's estimate
of x_k is a prediction for the plant whose measurement at k is y_{k+1}.

Why: y_k known, x_{k+1} = F x_k + S R^-1 y_k + w~_k with w~ = w - S R^-1 v of covariance Q~, correlated neither with v_k
nor with the filter's error. So P = F P+ F' + Q~, and y_{k+1} less what is known is C F x_k + C w~_k + v_{k+1}. The
measurement takes P to P+ = P - P C'(C P C' + R)^-1 C P, the Schur complement of the inequality. The optimal gain of the
other plant, (F P+ F' + Q~) C'(C P C' + R)^-1, is L_f. As R^-1 (I - C L_f) = (C P C' + R)^-1, F L_f + S R^-1 =
A L_f + S (C P C' + R)^-1 is the predictor's gain L.

(F, C F) is detectable as (A, C) is: an unstable mode F x = lambda x has C F x = lambda C x.

Requires: R > 0, [[Q, S], [S', R]] >= 0, (A, C) detectable, M > 0.

Source: B. D. O. Anderson and J. B. Moore, Optimal Filtering, 1979, chapters 3 (the two forms) and 5 (the shift by S).
"""

from dataclasses import replace

import numpy as np

from derive.errors import InputError
from derive.numeric.filter_form import predicted_covariance, predictor_gain
from derive.numeric.plant import Plant
from lmi.programs.optimal_covariance import optimal_covariance
from lmi.programs.program import Matrix, Program

__all__ = ["filter_form", "filter_plant"]


def filter_form(plant: Plant) -> Program:
    """State the program max tr(M P+) subject to the Riccati inequality of the filter.

    Args:
        plant: discrete; A (n, n), C (l, n), Q, R, S and the weight M of P+.

    Returns:
        The program; the variable holds P+, and its answer is the predictor's covariance P = F P+ F' + Q~ (n, n) and
        gain L (n, l), to be compared with other programs.

    Raises:
        InputError: the plant is continuous.

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> from lmi.solve import solve_program
        >>> plant = plant_from_mapping({"time": "discrete", "A": 2.0, "C": 1.0, "Q": 0.0, "R": 1.0})
        >>> program = filter_form(plant)
        >>> solve_program(program).status.value
        'solved'
        >>> bool(abs(program.answer()[0][0, 0] - 3.0) < 1e-8)
        True
    """
    inner = optimal_covariance(filter_plant(plant))
    now = [plant]

    def load(plant: Plant) -> bool:
        if plant.is_continuous or not inner.load(filter_plant(plant)):
            return False
        now[0] = plant
        return True

    def answer() -> tuple[Matrix, Matrix]:
        P = predicted_covariance(now[0], inner.answer()[0])
        return P, predictor_gain(now[0], P)

    return Program("largest filter covariance under the Riccati inequality", inner.problem, answer, load)


def filter_plant(plant: Plant) -> Plant:
    """Return the plant (F, C F, Q~, C Q~ C' + R, Q~ C'), whose predictor is the filter of a discrete plant.

    Raises:
        InputError: the plant is continuous.

    Example:
        >>> from derive.numeric.filter_form import filter_covariance, filter_gain
        >>> from derive.numeric.plant import plant_from_mapping
        >>> from derive.numeric.riccati import solve_riccati
        >>> plant = plant_from_mapping({"time": "discrete", "A": 2.0, "C": 1.0, "Q": 0.0, "R": 1.0})
        >>> P, other = solve_riccati(plant).P, solve_riccati(filter_plant(plant))
        >>> bool(np.allclose(other.P, filter_covariance(plant, P)) and np.allclose(other.gain, filter_gain(plant, P)))
        True
    """
    if plant.is_continuous:
        raise InputError('time: expected "discrete", got "continuous"; there the filter is the predictor')
    shift = np.linalg.solve(plant.V, plant.N.T).T
    F, noise = plant.A - shift @ plant.C, plant.W - shift @ plant.N.T
    noise = (noise + noise.T) / 2
    innovation = plant.C @ noise @ plant.C.T + plant.V
    return replace(plant, A=F, C=plant.C @ F, W=noise, V=(innovation + innovation.T) / 2, N=noise @ plant.C.T)
