"""Claims on the observer with general noise inputs, for any gain."""

from collections.abc import Callable
from typing import Any

from tests.reference.corpus import Entry

THEORY = "observer-ct"


def T(latex: str, sides: Callable[..., Any] | None, why: str = "", assume: tuple[str, ...] = ()) -> Entry:
    return Entry(latex, True, THEORY, sides, why, assume)


def F(latex: str, sides: Callable[..., Any] | None, why: str = "", assume: tuple[str, ...] = ()) -> Entry:
    return Entry(latex, False, THEORY, sides, why, assume)


def sigma(Bd: Any, Dd: Any, Dr: Any, L: Any, Sdd: Any, Sdr: Any, Srd: Any, Srr: Any) -> Any:
    """Return the intensity of (B_d - L D_d) d - L D_r r."""
    E, F_ = Bd - L * Dd, -(L * Dr)
    return E * Sdd * E.T + E * Sdr * F_.T + F_ * Srd * E.T + F_ * Srr * F_.T


ENTRIES = [
    T("A_e = A - L C", None, "the definition of the error matrix"),
    F("A_e = A + L C", None, "A = 0, C = L = 1: -1 against 1"),
    F("A_e = A - C L", None, "shapes: C L is l by l"),
    T("B_{ed} = B_d - L D_d", None, "the definition"),
    F("B_{ed} = B_d + L D_d", None, "the definition with the other sign"),
    T("B_{er} = - L D_r", None, "the definition"),
    F("B_{er} = L D_r", None, "the definition with the other sign"),
    T(r"\dot{e} = A_e e + B_{ed} d + B_{er} r", None, "plant minus observer"),
    T(r"\dot{e} = (A - L C) e + (B_d - L D_d) d - L D_r r", None, "plant minus observer"),
    F(r"\dot{e} = (A - L C) e + (B_d - L D_d) d + L D_r r", None, "the sign of r"),
    F(r"\dot{e} = (A + L C) e + (B_d - L D_d) d - L D_r r", None, "the sign of L C"),
    T(r"\xi = B_{ed} d + B_{er} r", None, "the definition"),
    T(r"\sigma_\xi^2 = B_{ed} S_{dd} B_{ed}^T + B_{ed} S_{dr} B_{er}^T + B_{er} S_{rd} B_{ed}^T + B_{er} S_{rr} B_{er}^T", None, "the intensity of xi"),
    F(r"\sigma_\xi^2 = B_{ed} S_{dd} B_{ed}^T + B_{er} S_{rr} B_{er}^T", None, "without the cross terms"),
    T(r"\sigma_\xi^2 = B_{ed} S_{dd} B_{ed}^T + B_{er} S_{rr} B_{er}^T", None, "d and r are uncorrelated", ("S_{dr} = 0",)),
    F(r"\sigma_\xi^2 = B_{ed} S_{dd} B_{ed}^T - B_{er} S_{rr} B_{er}^T", None, "the sign of the last term", ("S_{dr} = 0",)),
    T(
        r"(B_d - L D_d) S_{dd} (B_d - L D_d)^T - (B_d - L D_d) S_{dr} D_r^T L^T - L D_r S_{rd} (B_d - L D_d)^T + L D_r S_{rr} D_r^T L^T = \sigma_\xi^2",
        None,
        "the intensity of xi, written out",
    ),
    F(
        r"(B_d - L D_d) S_{dd} (B_d - L D_d)^T + (B_d - L D_d) S_{dr} D_r^T L^T - L D_r S_{rd} (B_d - L D_d)^T + L D_r S_{rr} D_r^T L^T = \sigma_\xi^2",
        None,
        "the sign of one cross term",
    ),
    T(r"S_{rd} = S_{dr}^T", None, "E[r d'] = E[d r']'"),
    F(r"S_{rd} = S_{dr}", None, "the transpose is missing; scalar noises hide it"),
    T(r"\dot{P}_e = A_e P_e + P_e A_e^T + \sigma_\xi^2", None, "the Lyapunov equation"),
    F(r"\dot{P}_e = A_e P_e + P_e A_e^T - \sigma_\xi^2", None, "the sign of the noise"),
    F(r"\dot{P}_e = A_e^T P_e + P_e A_e + \sigma_\xi^2", None, "the transposes"),
    T(r"\dot{P}_e = (A - L C) P_e + P_e (A - L C)^T + \sigma_\xi^2", None, "the Lyapunov equation"),
    F(r"\dot{P}_e = A P_e + P_e A^T + \sigma_\xi^2", None, "the gain is missing"),
    T(r"\sigma_\xi^2 \succeq 0", None, "an intensity"),
    T(
        "(A - L C) + L C = A",
        lambda A, L, C: ((A - L * C) + L * C, A),
    ),
]  # fmt: skip
