"""A second opinion on counterexamples: fractions and lists only, no code shared with the search.

Definiteness by Gaussian elimination, stability by solving a Lyapunov or Stein equation and testing its solution.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from derive.claim import Counterexample
from derive.kernel import Poly
from derive.matrix.hypotheses import Hypotheses

__all__ = ["confirm"]

Matrix = list[list[Fraction]]


def confirm(found: Counterexample, lhs: Poly, rhs: Poly, problem: Hypotheses) -> bool:
    """Decide whether an instance satisfies every hypothesis on its letters, and the two sides are as stated and fail.

    A hypothesis with a letter that the instance does not hold is not tested.
    """
    values = Values(found, problem)
    if not all(values.typed(name) for name in found.values):
        return False
    if not all(_is_zero(values.of(p)) for p in problem.relations.values() if values.covers(p)):
        return False
    for name, poly in problem.inverses.items():
        if name in found.values:
            inverse, matrix = values.letter(name), values.of(poly)
            if times(inverse, matrix) != eye(len(matrix)) or times(matrix, inverse) != eye(len(matrix)):
                return False
    for fact in problem.facts.values():
        if all(values.covers(p) for row in fact.matrix for p in row) and not _holds(
            fact.kind, join([[values.of(p) for p in row] for row in fact.matrix])
        ):
            return False
    if any(value < 0 for name, value in found.scalars.items() if name in problem.nonnegative):
        return False
    left, right = (values.of(p, found.trace) for p in (lhs, rhs))
    return (left, right) == ([*map(list, found.left)], [*map(list, found.right)]) and _fails(
        found.relation, left, right
    )


class Values:
    """The matrices of an instance."""

    def __init__(self, found: Counterexample, problem: Hypotheses):
        self.found, self.problem = found, problem

    def covers(self, poly: Poly) -> bool:
        """Tell whether every letter and scalar of a polynomial has a value."""
        letters = {a.replace("'", "") for _, word in poly.terms for a in word}
        scalars = {s for monomial, _ in poly.terms for s in monomial if s[0] != "δ"}
        return letters <= set(self.found.values) and scalars <= set(self.found.scalars)

    def size(self, dimension: str) -> int:
        """Return the value of a dimension name."""
        return int(dimension) if dimension.isdigit() else self.found.sizes.get(dimension, 1)

    def typed(self, name: str) -> bool:
        """Tell whether a letter's value has its shape, and is symmetric if the letter is."""
        value, declared = self.found.values[name], self.problem.alphabet.letters[name.partition("@")[0]]
        shape = len(value), {len(row) for row in value}
        turned = tuple(zip(*value, strict=True))
        return shape == (self.size(declared.rows), {self.size(declared.cols)}) and (
            not declared.symmetric or turned == value
        )

    def letter(self, name: str) -> Matrix:
        """Return the value of a letter or transposed letter."""
        value = [list(row) for row in self.found.values[name.replace("'", "")]]
        return [list(column) for column in zip(*value, strict=True)] if "'" in name else value

    def of(self, poly: Poly, trace: bool = False) -> Matrix:
        """Return the value of a polynomial, or its trace as a 1 x 1 matrix."""
        rows, cols = (1, 1) if trace else (self.size(poly.rows), self.size(poly.cols))
        total = [[Fraction(0)] * cols for _ in range(rows)]
        for (monomial, word), c in poly.terms.items():
            product = eye(self.size(poly.rows))
            if word:
                product = self.letter(word[0])
            for name in word[1:]:
                product = times(product, self.letter(name))
            if trace:
                product = [[sum((product[i][i] for i in range(len(product))), Fraction(0))]]
            factor = Fraction(c)
            for s in monomial:
                factor *= 0 if s[0] == "δ" else self.found.scalars[s]
            total = [[x + factor * y for x, y in zip(r, q, strict=True)] for r, q in zip(total, product, strict=True)]
        return total


# ------------------------------------------------------------------------------------------------ linear algebra
def eye(n: int) -> Matrix:
    """Return the identity matrix."""
    return [[Fraction(int(i == j)) for j in range(n)] for i in range(n)]


def times(a: Matrix, b: Matrix) -> Matrix:
    """Multiply two matrices."""
    columns = list(zip(*b, strict=True))
    return [[sum((x * y for x, y in zip(row, col, strict=True)), Fraction(0)) for col in columns] for row in a]


def join(blocks: Sequence[Sequence[Matrix]]) -> Matrix:
    """Put blocks together."""
    return [[x for block in row for x in block[i]] for row in blocks for i in range(len(row[0]))]


def eliminate(a: Matrix, b: Sequence[Fraction]) -> list[Fraction] | None:
    """Solve a x = b for a square matrix; None if it is singular."""
    work = [[*row, y] for row, y in zip(a, b, strict=True)]
    for k in range(len(work)):
        pivot = next((i for i in range(k, len(work)) if work[i][k]), None)
        if pivot is None:
            return None
        work[k], work[pivot] = work[pivot], work[k]
        for i in range(len(work)):
            if i != k and work[i][k]:
                ratio = work[i][k] / work[k][k]
                work[i] = [x - ratio * y for x, y in zip(work[i], work[k], strict=True)]
    return [work[k][-1] / work[k][k] for k in range(len(work))]


def definite(matrix: Matrix, strictly: bool) -> bool:
    """Decide M = M' >= 0 (> 0) by symmetric elimination."""
    work = [list(row) for row in matrix]
    if work != [list(column) for column in zip(*work, strict=True)]:
        return False
    while work:
        pivot, row = work[0][0], work[0]
        if pivot < 0 or (pivot == 0 and (strictly or any(row))):
            return False
        work = [[x - (y * row[0] and y * z / pivot if pivot else 0) for x, z in zip(r[1:], row[1:], strict=True)]
                for r in work[1:] for y in (r[0],)]  # fmt: skip
    return True


def stable(matrix: Matrix, discrete: bool) -> bool:
    """Decide whether M is Hurwitz (Schur): M X + X M' = -I (M X M' - X = -I) has a solution X > 0."""
    n = len(matrix)
    places = [(i, j) for i in range(n) for j in range(n)]

    def entry(i: int, j: int, k: int, m: int) -> Fraction:
        same_i, same_j = Fraction(int(i == k)), Fraction(int(j == m))
        if discrete:
            return matrix[i][k] * matrix[j][m] - same_i * same_j
        return matrix[i][k] * same_j + same_i * matrix[j][m]

    system = [[entry(i, j, k, m) for k, m in places] for i, j in places]
    solution = eliminate(system, [Fraction(-int(i == j)) for i, j in places])
    return solution is not None and definite([solution[i * n : i * n + n] for i in range(n)], strictly=True)


def _holds(kind: str, matrix: Matrix) -> bool:
    match kind:
        case "psd" | "pd":
            return definite(matrix, strictly=kind == "pd")
        case "hurwitz" | "schur":
            return stable(matrix, discrete=kind == "schur")
        case "invertible":
            return eliminate(matrix, [Fraction(0)] * len(matrix)) is not None
        case "nonzero":
            return not _is_zero(matrix)
        case _:
            return True


def _is_zero(matrix: Matrix) -> bool:
    return not any(x for row in matrix for x in row)


def _fails(relation: str, left: Matrix, right: Matrix) -> bool:
    if relation in ("=", "≠", "false"):
        return relation == "false" or (relation == "=") == (left != right)
    if relation == "invertible":
        return eliminate(left, [Fraction(0)] * len(left)) is None
    difference = [[x - y for x, y in zip(r, s, strict=True)] for r, s in zip(left, right, strict=True)]
    return not definite(difference, strictly=relation in ("≻", ">"))
