"""Enclosures of all eigenvalues of a matrix, with multiplicity: Gershgorin's discs after a refined diagonalisation."""

import numpy as np
from flint import acb, acb_mat, arb, ctx

__all__ = ["enclosed_eigenvalues"]

STEPS = 6
"""Refinements; each squares the size of what lies beside the diagonal."""

NEAR = 0.25
"""Eigenvalues are a cluster where an entry beside the diagonal is more than this times their distance."""


def enclosed_eigenvalues(H: acb_mat, bits: int) -> list[acb] | None:
    """Enclose the eigenvalues of every matrix in the balls H (n, n), each as often as its multiplicity.

    With R close to the matrix of eigenvectors and L to its inverse, T = R^-1 H R = (L R)^-1 L H R is nearly diagonal.
    A component of k overlapping Gershgorin discs of T holds k eigenvalues, each of which is given the box around the
    component.

    Args:
        H: the matrix.
        bits: relative accuracy at which the refinement stops.

    Returns:
        n balls, or None when the eigenvectors are too nearly dependent.

    Source: S. Gerschgorin, Ueber die Abgrenzung der Eigenwerte einer Matrix, 1931.
    """
    n = H.nrows()
    if n == 0:
        return []
    try:
        R, L = _start(H)
    except np.linalg.LinAlgError:
        return None
    before = float("inf")
    for _ in range(STEPS):
        L = _sharper(L, R)
        product = L * H * R
        gaps, beside = _gaps(product)
        if not beside < before or beside < -bits:
            break
        before = beside
        Y = _improvement(product, gaps)
        R, L = (R + R * Y).mid(), (L - Y * L).mid()
    else:
        product = L * H * R
    T = _similar(product, L, R)
    return None if T is None else _components(T)


def _start(H: acb_mat) -> tuple[acb_mat, acb_mat]:
    """Return eigenvectors and their inverse, in double precision."""
    centre = np.array([complex(x.mid()) for x in H.entries()]).reshape(H.nrows(), H.nrows())
    R = np.linalg.eig(centre)[1]
    R, L = (acb_mat([[complex(x) for x in row] for row in X]) for X in (R, np.linalg.inv(R)))
    return R, L


def _sharper(L: acb_mat, R: acb_mat) -> acb_mat:
    """Return the inverse of R after one of Newton's steps from L."""
    return (L * 2 - L * (R * L)).mid()


def _similar(product: acb_mat, L: acb_mat, R: acb_mat) -> acb_mat | None:
    """Return balls around R^-1 H R = (I - E)^-1 L H R, E = I - L R, from the product L H R.

    |(I - E)^-1 - I|_inf <= e / (1 - e) for e = |E|_inf < 1.
    """
    n = product.nrows()
    e = _row_sum(_identity(n) - L * R)
    if not e < 1:
        return None
    rest = arb(0, (e / (1 - e) * _row_sum(product)).abs_upper())
    return acb_mat(n, n, [x + acb(rest, rest) for x in product.entries()])


def _row_sum(X: acb_mat) -> arb:
    """Return an upper bound of |X|_inf."""
    largest = arb(0)
    for row in X.tolist():
        largest = largest.max(sum((x.abs_upper() for x in row), arb(0)))
    return arb(largest.abs_upper())


def _identity(n: int) -> acb_mat:
    return acb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])


def _gaps(T: acb_mat) -> tuple[list[list[acb]], float]:
    """Return d_j - d_i for the diagonal d, and log2 of the largest entry beside it relative to the largest on it."""
    rows = T.mid().tolist()
    d = [row[i] for i, row in enumerate(rows)]
    gaps = [[y - x for y in d] for x in d]
    beside = max((_log2(x) for i, row in enumerate(rows) for j, x in enumerate(row) if i != j), default=-float("inf"))
    return gaps, beside - max(map(_log2, d))


def _log2(x: acb) -> float:
    """Return log2 |x| to within one."""
    return float(max(_exponent(x.real), _exponent(x.imag)))


def _exponent(x: arb) -> int:
    man, exp = x.mid().man_exp()
    return int(exp) + int(man).bit_length() if man else -16 * ctx.prec


def _improvement(T: acb_mat, gaps: list[list[acb]]) -> acb_mat:
    """Return Y, Y_ij = T_ij / (T_jj - T_ii): R (I + Y) removes what is beside the diagonal to first order."""
    n = T.nrows()
    limit = np.log2(NEAR)
    Y = acb_mat(n, n)
    for i, row in enumerate(T.mid().tolist()):
        for j, entry in enumerate(row):
            if i != j and _log2(entry) < _log2(gaps[i][j]) + limit:
                Y[i, j] = entry / gaps[i][j]
    return Y.mid()


def _components(T: acb_mat) -> list[acb]:
    """Return the box of each row's component of discs."""
    rows = T.tolist()
    centres = [row[i] for i, row in enumerate(rows)]
    radii = [sum((x.abs_upper() for j, x in enumerate(row) if j != i), arb(0)) for i, row in enumerate(rows)]
    discs = [_disc(*pair) for pair in zip(centres, radii, strict=True)]
    groups: list[list[int]] = []
    for i, disc in enumerate(discs):
        touching = [group for group in groups if any(disc.overlaps(discs[j]) for j in group)]
        groups = [group for group in groups if group not in touching]
        groups.append([i, *(j for group in touching for j in group)])
    return [_box([discs[j] for j in group]) for group in groups for _ in group]


def _disc(centre: acb, radius: arb) -> acb:
    """Return the square around a disc."""
    ball = arb(0, radius.abs_upper())
    return centre + acb(ball, ball)


def _box(discs: list[acb]) -> acb:
    real, imag = discs[0].real, discs[0].imag
    for disc in discs[1:]:
        real, imag = real.union(disc.real), imag.union(disc.imag)
    return acb(real, imag)
