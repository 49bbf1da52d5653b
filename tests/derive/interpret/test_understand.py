"""What formulas say: their canonical form, shapes, what is ambiguous and what does not fit."""

from __future__ import annotations

from fractions import Fraction

import pytest

from derive.errors import InputError
from derive.functions import Abs, Definite, Max, Power, Quotient, Root
from derive.interpret import Misfit, NotUnderstood, echo, shapes
from derive.terms import Block, Equation, Gradient, Identity, Inverse, Number, Product, Symbol, Trace, Zero
from tests.derive.interpret.reading import meant

DT, KB, OB, CO, RC, RD = "luenberger-dt", "kalman-bucy", "observer-ct", "covariance-ct", "lqr-ct", "lqr-dt"
TYPED = [
    (DT, r"L_k = A P_{k-1} C^\top (C P_{k-1} C^\top + R)^{-1}", r"L_k = A P_{k-1} C^\top (C P_{k-1} C^\top + R)^{-1}"),
    (DT, r"P_{k|k} = (I - L_k^f C) P_{k|k-1}", r"P_k^+ = (I - L_k^f C) P_k"),
    (DT, r"P_{k+1|k} = A P_{k|k} A^T + Q", r"P_{k+1} = A P_k^+ A^\top + Q"),
    (DT, r"P \succeq Q \succeq 0", r"P \succeq Q, \quad Q \succeq 0"),
    (DT, r"P \preceq A P A^T + Q", r"A P A^\top + Q \succeq P"),
    (DT, r"R > 0", r"R \succ 0"),
    (DT, r"(1 - L_f C) P = P^+", r"(I - L_f C) P = P^+"),
    (DT, r"\frac12 (P + P^T) = P", r"\tfrac12 (P + P^\top) = P"),
    (DT, r"A^2 = A A", r"A A = A A"),
    (DT, r"A^{-\top} = (A^T)^{-1}", r"A^{-\top} = (A^\top)^{-1}"),
    (DT, r"\operatorname{tr} P_k = \operatorname{tr}(Q) + 3", r"\operatorname{tr}(P_k) = \operatorname{tr}(Q) + 3"),
    (DT, r"\mathbb E[e_k e_k^\top] = P_k", r"\mathbb{E}[e_k e_k^\top] = P_k"),
    (DT, r"x(k+1) = A x(k) + B u(k) + w(k)", r"x_{k+1} = A x_k + B u_k + w_k"),
    (DT, r"\frac{\partial \operatorname{tr} P_k}{\partial L_k} = 0",
     r"\frac{\partial}{\partial L_k}\operatorname{tr}(P_k) = 0"),
    (KB, r"A P + P A' + W = P C' V^{-1} C P", r"A P + P A^\top + W = P C^\top V^{-1} C P"),
    (KB, r"\dot P = A P + P A^T + W - K V K^T", r"\dot P(t) = A P(t) + P(t) A^\top + W - K(t) V K(t)^\top"),
    (KB, r"\mathbf{E}[w(t+\tau) w^T(t)] = W \delta(\tau)", r"\mathbb{E}[w(t+\tau) w(t)^\top] = W \delta(t+\tau - t)"),
    (KB, r"\mathbf{E}[w(t) w(\tau)^T] = W \delta(t-\tau)", r"\mathbb{E}[w(t) w(\tau)^\top] = W \delta(t - \tau)"),
    (KB, r"\Phi_y(s) = C(sI-A)^{-1}W(-sI-A)^{-T}C^T + V",
     r"\Phi_y(s) = C (s I - A)^{-1} W (-s I - A)^{-\top} C^\top + V"),
    (KB, r"\sum_{i=1}^m \Re[\lambda_i(A)] = \operatorname{tr} A",
     r"\sum_{i=1}^{m} \operatorname{Re} \lambda_i(A) = \operatorname{tr}(A)"),
    (OB, r"\dot{\mathbf e} = \mathbf{A}_e \mathbf e + \mathbf{B}_{ed} \mathbf d + \mathbf{B}_{er} \mathbf r",
     r"\dot e = A_e e + B_{ed} d + B_{er} r"),
    (OB, r"\mathbf{P}_e(t) = \mathbb E[\mathbf e(t) \mathbf e^*(t)]", r"P_e(t) = \mathbb{E}[e(t) e(t)^\top]"),
    (OB, r"\dot{\mathbf P}_{\mathbf e} = A_e P_e + P_e A_e^* + \sigma_\xi^2",
     r"\dot P_e = A_e P_e + P_e A_e^\top + \sigma_\xi^2"),
    (CO, r"\frac{d}{dt} \Phi(t,\tau) = A(t) \Phi(t,\tau)", r"\dot\Phi(t,\tau) = A(t) \Phi(t,\tau)"),
    (CO, r"X(0) = \int_0^t \Phi(t,\sigma) B(\sigma) N(\sigma) B(\sigma)^T \Phi(t,\sigma)^T d\sigma",
     r"X(t_0) = \int_{t_0}^{t} \Phi(t,\tau) B(\tau) N(\tau) B(\tau)^\top \Phi(t,\tau)^\top\,\mathrm{d}\tau"),
    (OB, r"L = (P_e C^* + N) R_e^{-1}", r"L = (P_e C^\top + N) R_e^{-1}"),
    (OB, r"\boldsymbol\xi = (B_d - L D_d) d - L D_r r", r"\xi = (B_d - L D_d) d - L D_r r"),
    (OB, r"\dot{\mathbf o} = A o + B u + L (y - y_o)", r"\dot o = A o + B u + L (y - y_o)"),
    (OB, r"R_{dr}(t,\tau) = S_{dr} \delta(t-\tau)", r"R_{dr}(t,\tau) = S_{dr} \delta(t - \tau)"),
    (OB, r"S_{rd} = S_{dr}^*", r"S_{rd} = S_{dr}^\top"),
    (OB, r"R_e = D_d S_{dd} D_d' + D_r S_{rr} D_r'", r"R_e = D_d S_{dd} D_d^\top + D_r S_{rr} D_r^\top"),
    (OB, r"\mathbf y - \mathbf y_o = C e + D_d d + D_r r", r"y - y_o = C e + D_d d + D_r r"),
    (CO, r"\Phi(\tau,\tau) = I", r"\Phi(\tau,\tau) = I"),
    (CO, r"\dot X = A X + X A^T + B N B^T", r"\dot X = A X + X A^\top + B N B^\top"),
    (CO, r"\dot{\bar x} = A \bar x + B \bar n", r"\dot{\bar x} = A \bar x + B \bar n"),
    (CO, r"X(t) = \mathbb E[\tilde x(t) \tilde x(t)^T]", r"X(t) = \mathbb{E}[\tilde x(t) \tilde x(t)^\top]"),
    (CO, r"\dot X_{sv} = A_{ss} X_{sv} + X_{sv} A_{vv}^T + A_{sv} X_{vv}",
     r"\dot X_{sv} = A_{ss} X_{sv} + X_{sv} A_{vv}^\top + A_{sv} X_{vv}"),
    (CO, r"X_{vv}(t) = X_{vv}(\infty)", r"X_{vv}(t) = X_{vv}^\infty"),
    (CO, r"\mathbb E[\tilde n(t) \tilde n(\tau)^T] = N(t) \delta(t-\tau)",
     r"\mathbb{E}[\tilde n(t) \tilde n(\tau)^\top] = N(t) \delta(t - \tau)"),
    (CO, r"X \succeq 0", r"X \succeq 0"),
    (KB, r"K(t) = P(t) C^T V^{-1}", r"K(t) = P(t) C^\top V^{-1}"),
    (KB, r"\Sigma_{\mathbf z - \bar{\mathbf y}} = C P C^T", r"\Sigma_{z-ȳ} = C P C^\top"),
    (KB, r"V^{-1/2} V = V^{1/2}", r"(V^{1/2})^{-1} V = V^{1/2}"),
    (KB, r"P(0) \succ 0", r"P(t_0) \succ 0"),
    (RC, r"\dot S = -(A^T S + S A + Q) + S B R^{-1} B^T S",
     r"\dot S(t) = -(A^\top S(t) + S(t) A + Q) + S(t) B R^{-1} B^\top S(t)"),
    (RC, r"u = -K x", r"u = -K x"),
    (RC, r"\dot x = (A - B K) x", r"\dot x = (A - B K) x"),
    (RC, r"A^T S + S A + Q = K^T R K", r"A^\top S + S A + Q = K^\top R K"),
    (RC, r"S \succeq 0", r"S \succeq 0"),
    (RC, r"x^T S x \ge 0", r"x^\top S x \succeq 0"),
    (RC, r"K(t) = R^{-1} B' S(t)", r"K(t) = R^{-1} B^\top S(t)"),
    (RC, r"S_\infty = S_\infty^T", r"S = S^\top"),
    (RC, r"\operatorname{tr}(B K) = \operatorname{tr}(K B)", r"\operatorname{tr}(B K) = \operatorname{tr}(K B)"),
    (RD, r"K = (B^T S B + R)^{-1} B^T S A", r"K = (B^\top S B + R)^{-1} B^\top S A"),
    (RD, r"u_k = -K_k x_k", r"u_k = -K_k x_k"),
    (RD, r"x_{k+1} = (A - B K_k) x_k", r"x_{k+1} = (A - B K_k) x_k"),
    (RD, r"S_{k-1} \succeq Q", r"S_{k-1} \succeq Q"),
    (RD, r"S = A' S A + Q - K' (B' S B + R) K", r"S = A^\top S A + Q - K^\top (B^\top S B + R) K"),
    (RD, r"K_{k-1} = (B^T S_k B + R)^{-1} B^T S_k A", r"K_{k-1} = (B^\top S_k B + R)^{-1} B^\top S_k A"),
    (RD, r"B^T S B + R \succ 0", r"B^\top S B + R \succ 0"),
    (RD, r"x_k^T Q x_k + u_k^T R u_k \ge 0", r"x_k^\top Q x_k + u_k^\top R u_k \succeq 0"),
    (RD, r"S_N = Q", r"S_N = Q"),
    (RC, r"K = R^{-1} B^T S", r"K = R^{-1} B^\top S"),
    (RD, r"S_k = A^T S_{k+1} (A - B K_k) + Q", r"S_k = A^\top S_{k+1} (A - B K_k) + Q"),
]  # fmt: skip


@pytest.mark.parametrize(("key", "latex", "said"), TYPED)
def test_a_formula_is_echoed(key: str, latex: str, said: str):
    assert echo(meant(key, latex)) == said


@pytest.mark.parametrize(("key", "latex", "said"), TYPED)
def test_an_echo_says_the_same(key: str, latex: str, said: str):
    assert meant(key, said).equations == meant(key, latex).equations


def test_other_notations_are_the_same_formula():
    bold = r"\mathbf L = \mathbf{A P C}^{\mathsf T} {\left( \mathbf{C P C}' + \mathbf R \right)}^{-1}"
    assert meant(DT, bold).equations == meant(DT, r"L = A P C^T (C P C^T + R)^{-1}").equations


def test_a_conjugate_transpose_turns_the_frequency():
    starred, plain = (meant(KB, rf"(C (j\omega I - A)^{{-1}})^{mark} = 0").equations[0].lhs for mark in ("*", "T"))
    assert starred != plain
    assert starred == meant(KB, r"(C (j (-\omega) I - A)^{-1})^T = 0").equations[0].lhs


def test_shapes_are_shown():
    found = shapes(meant(DT, r"L_k R L_k^T = \frac{1}{z} A"))
    assert found == {"L_k": "n×l", "R": "l×l", "z": "number", "A": "n×n"}
    assert shapes(meant(DT, "A = C", scalar=True)) == {"A": "number", "C": "number"}


def test_identity_and_zero_take_the_size_of_their_neighbours():
    (equation,) = meant(KB, r"(I + C (sI - A)^{-1} K) V = 0").equations
    assert isinstance(equation.lhs, Product)
    sizes = [t.size for t in _walk(equation) if isinstance(t, Identity)]
    assert sizes == ["l", "m"]
    assert equation.rhs == Zero("l", "l")


def _walk(equation: Equation):
    from derive.terms import walk

    yield from walk(equation.lhs)


# ------------------------------------------------------------------------------------------------ what does not fit
@pytest.mark.parametrize(
    ("key", "latex", "shapes_"),
    [
        (OB, "A_e = A - C L", ("n×n", "l×l")),
        (OB, "S_{rd} = S_{dr}", ("r×d", "d×r")),
        (DT, "L = P C (C P C^T + R)^{-1}", ("n×n", "l×n")),
        (DT, "L = A P (C P C^T + R)^{-1}", ("n×n", "l×l")),
        (DT, "L = C", ("n×l", "l×n")),
        (DT, "L^2 = A", ("n×l",)),
        (DT, "L^{-1} = A", ("n×l",)),
        (DT, r"\operatorname{tr} L = 0", ("n×l",)),
        (DT, r"L \succeq 0", ("n×l",)),
        (DT, r"x_k = \begin{bmatrix} A & C \\ B & R \end{bmatrix} x_k", ("l×n",)),
        (KB, r"\dot P = A P + P A^T + W - C V^{-1} C^T", ("l×m", "l×l")),
        (RD, "K = B^T S A + S", ("p×n", "n×n")),
    ],
)  # fmt: skip
def test_shapes_that_do_not_fit_are_named(key: str, latex: str, shapes_: tuple[str, ...]):
    with pytest.raises(Misfit) as error:
        meant(key, latex)
    assert all(shape in str(error.value) for shape in shapes_)


@pytest.mark.parametrize(
    ("latex", "readings"),
    [
        (
            r"L = \frac{A P C^T}{C P C^T + R}",
            (r"(C P C^\top + R)^{-1} A P C^\top", r"A P C^\top (C P C^\top + R)^{-1}"),
        ),
        (r"P = \pm Q", ("one with +", "one with -")),
        (r"|A| < 1", (r"\det(A)", "scalar")),
        (r"P = Q + 3", ("3 I", "scalar")),
        (r"\|A\| \le 1", ("norm",)),
        (r"P = \sqrt{A}", ("symmetric letter",)),
        (r"\ln P = 0", ("number",)),
        (r"P C^T R^{-1}", ("expected an equation or an inequality",)),
        (r"P_k \to P", ("no relation that is decided",)),
        (r"I = I", ("write I_n",)),
        (r"\mathbb E[x_k | y_k] = \hat x_k", ("conditional",)),
        (r"P = \begin{bmatrix} 1 & 0 \\ 0 & 1 \end{bmatrix}", ("a matrix of numbers",)),
        (r"\sum_{i=1}^{k} A = 0", ("a sum",)),
        (r"P^{0.3} = P", ("a whole number",)),
        (r"(((A^{64})^{64})^{64}) = A", ("a product of 4096 factors",)),
        (r"((((2^{64})^{64})^{64})^{64}) A = A", ("10000 bits",)),
        (r"P = \infty", ("no number",)),
        (r"P = \frac{Q}{0}", ("divided by zero",)),
    ],
)
def test_two_readings_are_an_error_that_names_them(latex: str, readings: tuple[str, ...]):
    with pytest.raises(NotUnderstood) as error:
        meant(DT, latex)
    assert not isinstance(error.value, Misfit)
    assert all(reading in str(error.value) for reading in readings)


def test_indices_are_close():
    with pytest.raises(InputError, match="at most 6 steps between them, got k-41 and k"):
        meant(DT, r"\mathbb E[e_k w_{k-41}^T] = 0")


def test_a_star_on_a_function_of_s_has_two_readings():
    with pytest.raises(NotUnderstood, match="the conjugate, or the value at -s"):
        meant(KB, "(sI - A)^* = 0")


# ------------------------------------------------------------------------------------------------ all dimensions 1
def test_where_all_dimensions_are_1_everything_is_a_number():
    (equation,) = meant(KB, r"P = \frac{V}{C^2}\left(A + \sqrt{A^2 + C^2 W / V}\right)", scalar=True).equations
    P, V, C, A, W = (meant(KB, f"{k} = 0", scalar=True).symbols[0] for k in "PVCAW")
    root = Root(Power(A, 2) + Quotient(Power(C, 2) * W, V))
    assert equation == Equation(P, "=", Quotient(V, Power(C, 2)) * (A + root))


@pytest.mark.parametrize(
    ("latex", "rhs"),
    [
        (r"P \le |C|", "Abs"),
        (r"P = \max\{0, A\}", "Max"),
        (r"P = 2^{-1}", "Number"),
        (r"P = \operatorname{tr}(A)", "Symbol"),
        (r"P = \Re[A]", "Symbol"),
        (r"P = \sum_{i=1}^m \Re[\lambda_i(A)]", "Symbol"),
        (r"P = A^T", "Symbol"),
        (r"P = I", "Number"),
    ],
)
def test_functions_of_numbers(latex: str, rhs: str):
    (equation,) = meant(KB, latex, scalar=True).equations
    side = equation.rhs if equation.relation == "=" else equation.lhs
    assert type(side).__name__ == rhs


def test_the_only_eigenvalue_is_the_number_itself():
    (equation,) = meant(KB, r"P = \sum_{i=1}^m \max\{0, \Re[\lambda_i(A)]\}", scalar=True).equations
    assert equation.rhs == Max(meant(KB, "A = 0", scalar=True).symbols[0])


def test_max_of_two_numbers():
    (equation,) = meant(KB, r"P = \max\{A, W\}", scalar=True).equations
    A, W = (meant(KB, f"{k} = 0", scalar=True).symbols[0] for k in "AW")
    assert equation.rhs == A + Max(W - A)
    assert meant(KB, r"P = |A|", scalar=True).equations[0].rhs == Abs(A)


def test_a_number_is_exact():
    assert meant(KB, "P = 0.1", scalar=True).equations[0].rhs == Number(Fraction(1, 10))


# ------------------------------------------------------------------------------------------------ operators
def test_a_gradient_is_that_of_a_trace():
    (equation,) = meant(DT, r"\frac{\partial P_k}{\partial L_k} = 0").equations
    assert isinstance(equation.lhs, Gradient)
    assert isinstance(equation.lhs.body, Trace)
    assert equation.rhs == Zero("n", "l")


def test_an_integral_over_the_frequency():
    (equation,) = meant(KB, r"\frac{1}{2\pi} \int_{-\infty}^{\infty} \ln\det\Phi_y(\omega) d\omega = 0").equations
    assert isinstance(equation.lhs, Product)
    assert isinstance(equation.lhs.factors[-1], Definite)


def test_a_block_matrix_takes_its_zeros_from_its_neighbours():
    (equation,) = meant(
        DT, r"\begin{bmatrix} Q & S \\ S^T & R \end{bmatrix} \succeq \begin{bmatrix} Q & 0 \\ 0 & 0 \end{bmatrix}"
    ).equations
    assert isinstance(equation.rhs, Block)
    assert equation.rhs.rows[1] == (Zero("l", "n"), Zero("l", "l"))


def test_one_row_and_column_beside_a_number_is_its_trace():
    (equation,) = meant(DT, r"\mathbb E[e_k^T e_k] = \operatorname{tr} P_k").equations
    assert isinstance(equation.lhs, Trace)
    assert isinstance(equation.rhs, Trace)


def test_letters_come_in_the_order_of_their_appearance():
    assert [s.name for s in meant(DT, "L = A P C^T (C P C^T + R)^{-1}").symbols] == ["L", "A", "P", "C", "R"]


def test_an_inverse_is_kept_as_it_was_written():
    (equation,) = meant(DT, r"R^{-1} = (R^{-1})^T").equations
    assert isinstance(equation.lhs, Inverse)
    assert isinstance(equation.lhs.body, Symbol)
