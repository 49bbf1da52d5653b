"""The structure-preserving doubling algorithm in high precision: a stabilising start where there is none."""

from flint import arb, arb_mat, ctx

from derive.numeric.balls import identity, middle, norm
from derive.numeric.newton import Equation

__all__ = ["stabilising_start"]

DOUBLINGS = 128
"""Squarings of the closed loop before a solution is given up."""


SPARK = 2.0**-20
"""Noise added, relative to the natural size of the process noise, so that no mode is without."""


def stabilising_start(equation: Equation) -> arb_mat | None:
    """Approximate a P whose closed loop is stable: the solution for a little more process noise, unproved.

    The noise q + e I excites all modes, so that the solution rises from 0; and as it has R(P) = -e I, Newton's method
    goes down from it to the stabilising solution for q.
    For P = F (P^-1 + G)^-1 F' + q, start with E = F', G, H = q and repeat, with Z = (I + G H)^-1,
    H <- H + E' H Z E, G <- G + E Z G E', E <- E Z E: H rises to P, and E is the closed loop's power 2^k.
    In continuous time Cayley's transform with a > 0, F_a = F - a and S = (F_a + q F_a^-T G)^-1, turns the equation into
    the discrete one with E = I + 2 a S', G = 2 a F_a^-T G S, H = 2 a S q F_a^-T.

    Args:
        equation: the equation, (F, C) detectable, q >= 0.

    Returns:
        P (n, n), or None when the numbers run out.

    Source: E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, A structure-preserving doubling algorithm for continuous-time algebraic
        Riccati equations, Linear Algebra Appl. 396 (2005) 55-80; stated for the regulator, the dual.
    """
    F, G = equation.F.mid(), middle(equation.C.transpose() * equation.V.solve(equation.C))
    natural = norm(equation.q)
    if norm(G) > 0:
        natural = natural.max(norm(F) ** 2 / norm(G))
    q = middle(equation.q + identity(equation.n) * (natural * SPARK))
    try:
        return _limit(*(_cayley(F, G, q) if equation.time == "continuous" else (F.transpose(), G, q)))
    except ZeroDivisionError:
        return None


def _cayley(F: arb_mat, G: arb_mat, q: arb_mat) -> tuple[arb_mat, arb_mat, arb_mat]:
    one = identity(F.nrows())
    a = (norm(F) + (norm(G) * norm(q)).sqrt()).mid()
    shifted = (F - one * a).transpose().inv().mid()
    S = ((F - one * a) + q * shifted * G).inv().mid()
    E, G, H = one + S.transpose() * (2 * a), shifted * G * S * (2 * a), S * q * shifted * (2 * a)
    return E.mid(), middle(G), middle(H)


def _limit(E: arb_mat, G: arb_mat, H: arb_mat) -> arb_mat | None:
    one = identity(E.nrows())
    for _ in range(DOUBLINGS):
        Z = (one + G * H).inv().mid()
        ZE = (Z * E).mid()
        step = middle(E.transpose() * H * ZE)
        G, H, E = middle(G + E * Z * G * E.transpose()), middle(H + step), (E * ZE).mid()
        if not (norm(H).is_finite() and norm(E).is_finite()):
            return None
        if norm(step) <= norm(H) * arb(2) ** (16 - ctx.prec):
            return H
    return None
