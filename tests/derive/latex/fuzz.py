r"""Random input for the reader: formulas built by a grammar, mutations of real ones, and soup of tokens and bytes.

``python tests/derive/latex/fuzz.py 200000`` reads so many and reports failures and the longest time; what is read
must be read again from its canonical form.
"""

from __future__ import annotations

import random
import sys
import time
from pathlib import Path

from derive.latex.grammar import read
from derive.latex.spell import spell
from derive.latex.tokens import Unreadable, caret

FOLDER = Path(__file__).parent / "displays"


def words(text: str) -> list[str]:
    """Return the words of a text."""
    return text.split()


LETTERS = words(
    r"A B C P K L Q R V W x y t k s d T f I \Phi \omega \tau \sigma \xi \lambda \rho \pi"
    r" \hat{x} \dot{P} \mathbf{A} \bar{x} \tilde{\mathbf{x}} \dot{\hat{x}} \mathcal{H} \mathrm{ref}"
)
NUMBERS = words(r"0 1 2 10 3.5 \infty")
SCRIPTS = words(
    r"^T ^\top ^{-1} ' ^* ^{-\top} ^{1/2} ^2 _k _{k-1} _{k|k-1} ^+ ^{-} _\infty _0^2 ^k _{\mathrm{ss}} _{\xi\xi} ^{(i)}"
    r" ^\dagger ^H ^{\top/2} _{t_0} _{z-\bar{y}} _k^{-1} ^{\text{ref}}"
)
MARKS = ["", "", "", "", *SCRIPTS]
SOUP = words(
    r"\\ \{ \} \| \left( \right) \left| \right| \right. \left. \frac \sqrt \int \sum \prod \lim \max \det"
    r" \operatorname{tr} \mathrm{tr} \mathrm{d} \mathbf \hat \dot \mathbb{E} E[ \to \preceq \succ \ne := \quad \,"
    r" \text{and} \begin{bmatrix} \end{bmatrix} \begin{cases} \end{cases} \begin{aligned} \end{aligned} \overset"
    r" \underset \boxed \partial dt \cdot \frac{d}{dt} \times \dots \forall \label{a} \tag{1} $$ ẋ x̂ ₖ ² ᵀ ⁻¹ ⪰ Σ"
    r" ∫ √ ½ \rm \right \left \big \mid \lVert \underbrace \overline \bar \begin{array}{cc} \end{array} \substack"
    r" \limits #1 \a \E \delta ^{-T} ^t"
)
FRAGMENTS = [*LETTERS, *NUMBERS, *SCRIPTS, *SOUP, *"+-*/=<>(){}[]|&,.;:!^_'~%$\n\0", "\u202e", "\ud800", "\ufffd"]


def real() -> list[str]:
    """Return the displayed formulas of the tests."""
    blocks = [b for f in sorted(FOLDER.glob("*.txt")) for b in f.read_text(encoding="utf-8").strip().split("\n\n")]
    return [line for b in blocks for line in ([b] if "%" in b else b.splitlines())]


class Builder:
    """Builds LaTeX by the grammar of the field, so that most of it is read."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng

    def pick(self, *options: str) -> str:
        """Return one of the options."""
        return self.rng.choice(options)

    def letter(self) -> str:
        """Return a letter with scripts."""
        return self.rng.choice(LETTERS) + self.rng.choice(MARKS)

    def operand(self, depth: int) -> str:
        """Return an operand."""
        if depth <= 0 or self.rng.random() < 0.6:
            return self.letter()
        inner, other, product = self.sum(depth - 1), self.sum(depth - 1), self.product(depth - 1)
        letter, mark = self.letter(), self.rng.choice((*MARKS[:5], "^T", "^{-1}", "'"))
        return self.pick(
            *(f"({inner}){mark}", rf"\left[{inner}\right]^{{-1}}", rf"\frac{{{inner}}}{{{other}}}", f"|{inner}|"),
            *(
                rf"\sqrt{{{inner}}}",
                rf"\|{inner}\|_2^2",
                rf"\operatorname{{tr}}({inner})",
                rf"\det\left({inner}\right)",
            ),
            *(rf"\mathbb{{E}}[{inner}]", rf"\int_0^t {inner} \, d\tau", rf"\int {product} \frac{{d\omega}}{{2\pi}}"),
            *(rf"e^{{{inner}}}", rf"\max\{{{inner}, {other}\}}", rf"\sum_{{i=1}}^n {product}", rf"\ln({inner})"),
            *(rf"\begin{{bmatrix}} {inner} & {other} \\ {other} & 0 \end{{bmatrix}}", rf"\Phi({inner}, {other})"),
            *(rf"\frac{{d}}{{dt}} {letter}", rf"\lim_{{t \to \infty}} {product}", f"{letter}/{self.letter()}"),
            *(f"{letter}({inner})", rf"\Re[{inner}]", rf"\frac{{d {product}}}{{dt}}", rf"\mathbf{{{inner}}}"),
            *(rf"\overline{{{inner}}}", rf"\det {letter}", f"f({self.pick('t', 's', 'k-1', 't, s')}){mark}"),
        )

    def product(self, depth: int) -> str:
        """Return a product, perhaps with a number in front."""
        sign = self.pick(" ", " ", r" \cdot ", "")
        factors = [self.operand(depth) for _ in range(self.rng.choice((1, 1, 2, 2, 3)))]
        return (self.rng.choice(NUMBERS) + " ") * (self.rng.random() < 0.15) + sign.join(factors)

    def sum(self, depth: int) -> str:
        """Return a sum."""
        count = self.rng.choice((1, 1, 1, 2, 3))
        return self.pick("", "", "", "-") + self.pick(" + ", " - ").join(self.product(depth) for _ in range(count))

    def statement(self, depth: int = 2) -> str:
        """Return a chain of relations."""
        sides = [self.sum(depth) for _ in range(self.rng.choice((1, 2, 2, 3)))]
        return self.pick(" = ", " = ", r" \succeq ", r" \le ", " := ", r" \to ").join(sides)

    def display(self) -> str:
        """Return a display."""
        rows = [self.statement() for _ in range(self.rng.choice((1, 1, 1, 2, 3)))]
        return self.pick(
            ", ".join(rows), r"\begin{aligned}" + r" \\ ".join(rows) + r"\end{aligned}", r" \quad ".join(rows)
        )


def mutated(source: str, rng: random.Random) -> str:
    """Return a source with a few characters dropped, doubled, swapped, replaced, or fragments put in."""
    text = list(source)
    for _ in range(rng.choice((1, 1, 2, 3, 8))):
        i = rng.randrange(len(text) + 1)
        change = rng.randrange(5)
        if change == 0:
            del text[i : i + rng.choice((1, 1, 4))]
        elif change == 1:
            text[i:i] = text[i : i + rng.choice((1, 5, 20))]
        elif change == 2:
            text[i:i] = rng.choice(FRAGMENTS)
        elif change == 3:
            text[i : i + 1] = chr(rng.choice((rng.randrange(128), rng.randrange(0x3000), rng.randrange(0x110000))))
        else:
            j = rng.randrange(len(text) + 1)
            text[min(i, j) : max(i, j)] = reversed(text[min(i, j) : max(i, j)])
    return "".join(text)


def source(rng: random.Random, formulas: list[str]) -> str:
    """Return one random input."""
    kind = rng.random()
    if kind < 0.3:
        return Builder(rng).display()
    if kind < 0.5:
        return mutated(Builder(rng).display(), rng)
    if kind < 0.8:
        return mutated(rng.choice(formulas), rng)
    if kind < 0.95:
        return rng.choice(("", " ")).join(rng.choice(FRAGMENTS) for _ in range(rng.randrange(1, 40)))
    return rng.randbytes(rng.randrange(1, 60)).decode("utf-8", errors=rng.choice(("replace", "surrogateescape")))


def check(text: str) -> bool:
    """Read a text; return whether it is a formula, which must be read again from its canonical form."""
    try:
        display = read(text)
    except Unreadable as error:
        refusal = error
    else:
        again = read(spell(display))
        assert again == display, (spell(display), spell(again))
        return True
    assert "\n" not in str(refusal)
    assert 0 <= refusal.column <= len(text)
    assert caret(text, refusal).count("\n") == 1
    return False


def main(count: int, seed: int = 0) -> None:
    """Read ``count`` random inputs and report."""
    rng, formulas = random.Random(seed), real()
    good = failures = 0
    longest, slowest = 0.0, ""
    for i in range(count):
        if i and not i % 20_000:
            print(f"{i} inputs: {good} read, {failures} failures, longest {longest:.3f} s", flush=True)
        text = source(rng, formulas)
        start = time.process_time()
        try:
            good += check(text)
        except Exception as error:
            failures += 1
            print(f"{type(error).__name__}: {error!s:.300}\n  {text!r}", flush=True)
        seconds = time.process_time() - start
        if seconds > longest:
            longest, slowest = seconds, text
    print(f"{count} inputs: {good} read, {failures} failures, longest {longest:.3f} s for {len(slowest)} characters")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
