"""Exact properties of rational matrices: definiteness and stability, decided from the characteristic polynomial."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import fmpq, fmpq_mat

__all__ = ["PROPERTIES", "hurwitz", "invertible", "nonzero", "positive_definite", "positive_semidefinite", "schur"]


def positive_semidefinite(matrix: fmpq_mat) -> bool:
    """Decide M = M' >= 0: with real eigenvalues, the coefficients of det(s I - M) must alternate in sign or vanish."""
    return matrix == matrix.transpose() and all(c >= 0 for c in _alternated(matrix))


def positive_definite(matrix: fmpq_mat) -> bool:
    """Decide M = M' > 0."""
    return matrix == matrix.transpose() and all(c > 0 for c in _alternated(matrix))


def hurwitz(matrix: fmpq_mat) -> bool:
    """Decide whether every eigenvalue has a negative real part (Routh's array)."""
    return _routh(list(matrix.charpoly()))


def schur(matrix: fmpq_mat) -> bool:
    """Decide whether every eigenvalue is inside the unit circle (Routh's array after z = (1 + w) / (1 - w))."""
    from flint import fmpq_poly

    coefficients, n = list(matrix.charpoly()), matrix.nrows()
    up, down = fmpq_poly([1, 1]), fmpq_poly([1, -1])
    image = sum((up**k * down ** (n - k) * c for k, c in enumerate(coefficients)), fmpq_poly())
    return image.degree() == n and _routh(list(image))


def invertible(matrix: fmpq_mat) -> bool:
    """Decide det M != 0."""
    return matrix.nrows() == matrix.ncols() and matrix.det() != 0


def nonzero(matrix: fmpq_mat) -> bool:
    """Decide M != 0."""
    return any(x != 0 for x in matrix.entries())


def _alternated(matrix: fmpq_mat) -> list[fmpq]:
    n = matrix.nrows()
    return [c * (-1) ** (n - k) for k, c in enumerate(list(matrix.charpoly())[:n])]


def _routh(ascending: list[fmpq]) -> bool:
    """Decide whether every root has a negative real part: the first column of Routh's array keeps one strict sign."""
    leading = ascending[-1]
    c = [x / leading for x in reversed(ascending)]
    above, below = c[0::2], c[1::2]
    while below:
        if below[0] <= 0:
            return False
        padded = below + [below[0] * 0] * (len(above) - len(below))
        above, below = below, [a - above[0] * b / below[0] for a, b in zip(above[1:], padded[1:], strict=True)]
    return True


PROPERTIES = {
    "psd": positive_semidefinite,
    "pd": positive_definite,
    "hurwitz": hurwitz,
    "schur": schur,
    "invertible": invertible,
    "nonzero": nonzero,
}
