"""The filter form of the discrete estimator: the error after the measurement of the same instant is used."""

import numpy as np

from derive.errors import InputError
from derive.numeric.modes import Matrix
from derive.numeric.plant import Plant

__all__ = ["filter_covariance", "filter_gain", "predicted_covariance", "predictor_gain"]


def filter_gain(plant: Plant, P: Matrix) -> Matrix:
    """Return L_f = P C' (C P C' + R)^-1 (n, l), by which xhat+ = xhat + L_f (y - C xhat) uses a measurement.

    L_f does not depend on the cross term: the measurement noise v_k is correlated with w_k, which moves the state only
    after the measurement.

    Args:
        plant: discrete, R > 0.
        P: covariance of the predicted state (n, n) [state]^2, P >= 0.

    Raises:
        InputError: the plant is continuous; there the prediction and the filter are the same.

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> plant = plant_from_mapping({"time": "discrete", "A": 2.0, "C": 1.0, "Q": 0.0, "R": 1.0})
        >>> float(filter_gain(plant, np.array([[3.0]]))[0, 0])
        0.75
    """
    _check_discrete(plant)
    return np.linalg.solve(plant.C @ P @ plant.C.T + plant.V, plant.C @ P).T


def filter_covariance(plant: Plant, P: Matrix) -> Matrix:
    """Return P+ = P - P C' (C P C' + R)^-1 C P (n, n), the covariance after the measurement.

    Computed as (I - L_f C) P (I - L_f C)' + L_f R L_f', which subtracts nothing and is therefore >= 0 as rounded.

    Args:
        plant: discrete, R > 0.
        P: covariance of the predicted state (n, n) [state]^2, P >= 0.

    Raises:
        InputError: the plant is continuous.

    Source: P. D. Joseph's form; R. S. Bucy and P. D. Joseph, Filtering for Stochastic Processes with Applications to
        Guidance, 1968.

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> plant = plant_from_mapping({"time": "discrete", "A": 2.0, "C": 1.0, "Q": 0.0, "R": 1.0})
        >>> float(filter_covariance(plant, np.array([[3.0]]))[0, 0])
        0.75
    """
    gain = filter_gain(plant, P)
    kept = np.eye(plant.n) - gain @ plant.C
    filtered = kept @ P @ kept.T + gain @ plant.V @ gain.T
    return (filtered + filtered.T) / 2


def predicted_covariance(plant: Plant, filtered: Matrix) -> Matrix:
    """Return P = F P+ F' + Q - S R^-1 S', F = A - S R^-1 C, the covariance of the next prediction.

    With y_k known, x_{k+1} = F x_k + S R^-1 y_k + (w_k - S R^-1 v_k), and w_k - S R^-1 v_k is correlated neither with
    v_k nor with the error of the filter.

    Args:
        plant: discrete, R > 0, [[Q, S], [S', R]] >= 0.
        filtered: P+ (n, n) [state]^2.

    Raises:
        InputError: the plant is continuous.
    """
    _check_discrete(plant)
    shift = np.linalg.solve(plant.V, plant.N.T).T
    F = plant.A - shift @ plant.C
    P = F @ filtered @ F.T + plant.W - shift @ plant.N.T
    return (P + P.T) / 2


def predictor_gain(plant: Plant, P: Matrix) -> Matrix:
    """Return L = A L_f + S (C P C' + R)^-1 (n, l), the gain of xhat_{k+1} = A xhat_k + L (y_k - C xhat_k).

    Args:
        plant: discrete, R > 0.
        P: covariance of the predicted state (n, n) [state]^2, P >= 0.

    Raises:
        InputError: the plant is continuous.
    """
    innovation = plant.C @ P @ plant.C.T + plant.V
    return plant.A @ filter_gain(plant, P) + np.linalg.solve(innovation, plant.N.T).T


def _check_discrete(plant: Plant) -> None:
    if plant.is_continuous:
        raise InputError(
            'time: expected "discrete", got "continuous"; there the filter is the predictor, use its P and gain'
        )
