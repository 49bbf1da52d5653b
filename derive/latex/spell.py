r"""Canonical LaTeX of a tree that was read: ``read(spell(display)) == display``.

Spaces, brackets that grow, styles and the many spellings of one thing are gone; order, brackets and letters stay.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Mapping
from fractions import Fraction

from derive.latex.application import Reading, reading
from derive.latex.syntax import (
    Applied,
    Barred,
    Blank,
    Called,
    Cases,
    Differentiated,
    Digits,
    Display,
    Dotted,
    Expected,
    Fenced,
    Given,
    Infinite,
    Integrated,
    Inverted,
    Listed,
    Matrix,
    Name,
    Node,
    Over,
    Plus,
    Radical,
    Raised,
    Related,
    Summed,
    Times,
    Transposed,
    walk,
)
from derive.latex.vocabulary import BLACKBOARD, COMBINING, LETTER_OF, LETTERS, MARKS, MATRICES, OPEN_FUNCTIONS

COMMANDS = {
    ":=": ":=", "≤": r"\le", "≥": r"\ge", "≺": r"\prec", "≻": r"\succ", "⪯": r"\preceq", "⪰": r"\succeq", "≠": r"\ne",
    "→": r"\to", "∈": r"\in", "∼": r"\sim", "≈": r"\approx", "⇒": r"\implies", "⇔": r"\iff", "∝": r"\propto",
    "≪": r"\ll", "≫": r"\gg", "⊂": r"\subset", "⊆": r"\subseteq", "±": r"\pm", "∓": r"\mp",
}  # fmt: skip
OPERATORS = frozenset(("tr", "diag", "rank", "argmin", "argmax", "cov", "var", "vec", "sgn", "blkdiag", "spec", "null",
                       "span", "col", "Re", "Im"))  # fmt: skip
FENCES = {"(": ("(", ")"), "[": ("[", "]"), "{": (r"\{", r"\}"), "|": ("|", "|"), "‖": (r"\|", r"\|")}
TRANSPOSE = {"top": r"\top", "T": "T", "star": "*", "dagger": r"\dagger", "H": "H"}
SIGN_OF = {sign: name for name, sign in MARKS.items() if name not in ("prime", "ast", "pm")}
DOUBLE_STRUCK = {letter: name for name, letter in BLACKBOARD.items() if len(letter) == 1 and letter not in "I1"}
ACCENT = {combining: name for name, combining in COMBINING.items()}
ENVIRONMENT = {fence: name for name, fence in MATRICES.items() if name[1:] == "matrix" or name == "matrix"}
TALL = (Over, Matrix, Summed, Integrated, Cases)


def spell(tree: Display | Node) -> str:
    """Return the canonical LaTeX of a display or of one node."""
    if not isinstance(tree, Display):
        return _spell(tree)
    pieces = [rf"\text{{{tree.words[0]}}} "] if tree.words and tree.words[0] else []
    for i, statement in enumerate(tree.statements):
        word = tree.words[i + 1] if i + 1 < len(tree.words) else ""
        last = i + 1 == len(tree.statements)
        pieces.append(_spell(statement) + (rf" \text{{{word}}} " if word else "" if last else r" ;\quad "))
    pieces += [rf" \label{{{tree.label}}}"] * bool(tree.label) + [rf" \tag{{{tree.tag}}}"] * bool(tree.tag)
    return "".join(pieces).strip()


def _spell(node: Node) -> str:
    return SPELLINGS[type(node)](node)


# ------------------------------------------------------------------------------------------------ leaves and scripts
def _name(node: Name) -> str:
    text = _letter(node.letter)
    for accent in node.accents:
        text = rf"\{'mathring' if accent == 'ring' else accent}{{{text}}}"
    text += f"_{{{_index(node.sub)}}}" if node.sub else ""
    if node.sup.replace(" ", "").isalnum():
        return rf"{text}^{{\text{{{node.sup}}}}}"
    return text + (f"^{{{_index(node.sup)}}}" if node.sup else "")


def _letter(letter: str) -> str:
    if letter in DOUBLE_STRUCK:
        return rf"\mathbb{{{DOUBLE_STRUCK[letter]}}}"
    if letter in LETTERS or letter in ("partial", "hbar"):
        return "\\" + letter
    return letter if len(letter) == 1 else rf"\mathrm{{{letter}}}"


def _index(text: str) -> str:
    """Write an index as LaTeX: Greek letters, signs and accents as commands."""
    pieces: list[str] = []
    for char in unicodedata.normalize("NFD", text):
        if char in ACCENT and pieces:
            pieces[-1] = rf"\{'mathring' if ACCENT[char] == 'ring' else ACCENT[char]}{{{pieces[-1]}}}"
        elif char in LETTER_OF and char != "∞":
            pieces.append(rf"\{LETTER_OF[char]} ")
        elif char in SIGN_OF:
            pieces.append(rf"\{SIGN_OF[char]} ")
        else:
            pieces.append({"…": r"\dots "}.get(char, char))
    return "".join(pieces).rstrip()


def _digits(node: Digits) -> str:
    top, bottom, places = node.value.numerator, node.value.denominator, 0
    while bottom != 1:
        top, bottom, places = *Fraction(top * 10, bottom).as_integer_ratio(), places + 1
    text = str(top).rjust(places + 1, "0")
    return f"{text[:-places]}.{text[-places:]}" if places else text


def _base(node: Node) -> str:
    """Write what carries an exponent; braces hold what has one already, or ends in what is no single factor."""
    single = isinstance(node, (Digits, Fenced, Matrix, Applied, Expected, Infinite)) or (
        isinstance(node, Name) and not node.sup
    )
    return _spell(node) if single else f"{{{_spell(node)}}}"


def _transposed(node: Transposed) -> str:
    body = node.body
    if node.mark == "prime":
        return _base(body) + "'"
    mark = TRANSPOSE[node.mark]
    if isinstance(body, Inverted):
        return f"{_base(body.body)}^{{-{mark}}}"
    if isinstance(body, Raised) and body.exponent == HALF:
        return f"{_base(body.body)}^{{{mark}/2}}"
    return f"{_base(body)}^{{{mark}}}"


HALF = Over(Digits(Fraction(1)), Digits(Fraction(2)))


# ------------------------------------------------------------------------------------------------ sums and products
def _plus(node: Plus) -> str:
    text = ""
    for i, (sign, addend) in enumerate(node.addends):
        written = COMMANDS.get(sign, sign)
        if i:
            text += f" {written} {_spell(addend)}"
        else:
            text += ("" if sign == "+" and len(node.addends) > 1 else written) + " " * (sign in "±∓") + _spell(addend)
    return text


def _times(node: Times) -> str:
    pieces = [_closed(f) if isinstance(f, Called) else _spell(f) for f in node.factors[:-1]] + [
        _spell(node.factors[-1])
    ]
    text = pieces[0]
    for left, right, piece in zip(node.factors, node.factors[1:], pieces[1:], strict=False):
        text += (r" \cdot " if _needs_sign(left, right, piece) else " ") + piece
    return text


def _needs_sign(left: Node, right: Node, piece: str) -> bool:
    """Return whether two factors side by side would be read as something else."""
    if piece[0].isdigit() or left == Name("d"):
        return True
    group = _core(right)
    head = _core(left)
    if not isinstance(head, Name) or not isinstance(group, Fenced) or (isinstance(left, Raised) and head == Name("e")):
        return False
    if head.letter == "E" and group.fence in "[{":
        return True
    return group.fence in "([" and reading(head, group) != Reading.PRODUCT


def _core(node: Node) -> Node:
    """Return what a node is without exponents."""
    while isinstance(node, (Transposed, Inverted, Raised)):
        node = node.body
    return node


def _over(node: Over) -> str:
    return rf"\frac{{{_spell(node.top)}}}{{{_spell(node.bottom)}}}"


# ------------------------------------------------------------------------------------------------ brackets
def _fence(body: Node, left: str, right: str) -> str:
    inner = _spell(body)
    if left in ("|", r"\|") or any(isinstance(part, TALL) for part in walk(body)):
        return rf"\left{left} {inner} \right{right}"
    return f"{left}{inner}{right}"


def _fenced(node: Fenced) -> str:
    left, right = FENCES.get(node.fence, (node.fence[:1], node.fence[1:]))
    return _fence(node.body, left, right) + (f"_{{{_index(node.sub)}}}" if node.sub else "")


def _applied(node: Applied) -> str:
    return _spell(node.head) + _fence(Listed(node.arguments), "(", ")")


def _listed(node: Listed) -> str:
    return ", ".join(map(_spell, node.items))


def _called(node: Called) -> str:
    """Write a function; what has something below it acts on the product behind it."""
    body = node.arguments[0]
    single = len(node.arguments) == 1 and not isinstance(body, Plus)
    if node.function not in OPEN_FUNCTIONS or not single or not (node.sub is not None or node.function == "lim"):
        return _closed(node)
    text = _spell(body)
    return _closed(node) if text.startswith((r"\{", r"\left\{")) else f"{_function(node)} {text}"


def _function(node: Called) -> str:
    name = {"argmin": r"arg\,min", "argmax": r"arg\,max"}.get(node.function, node.function)
    text = rf"\operatorname{{{name}}}" if node.function in OPERATORS else "\\" + name
    return text + (f"_{{{_spell(node.sub)}}}" if node.sub is not None else "")


def _closed(node: Called) -> str:
    """Write a function with brackets around its arguments."""
    return _function(node) + _fence(Listed(node.arguments), *FENCES["{" if node.function in OPEN_FUNCTIONS else "("])


# ------------------------------------------------------------------------------------------------ operators
def _differentiated(node: Differentiated) -> str:
    sign, power = r"\partial" if node.partial else "d", f"^{{{node.order}}}" if node.order > 1 else ""
    body = _spell(node.body)
    body = rf"\cdot {body}" if body[0].isdigit() else body
    return rf"\frac{{{sign}{power} {body}}}{{{sign} {_base(node.variable)}{power}}}"


def _dotted(node: Dotted) -> str:
    return rf"\{'d' * node.order}ot{{{_spell(node.body)}}}"


def _summed(node: Summed) -> str:
    below = "" if node.index is None else _spell(node.index)
    below += f" = {_spell(node.lower)}" if node.lower is not None else ""
    return rf"\{node.sign}{_limits(below, node.upper)} {_spell(node.body)}"


def _limits(below: str, upper: Node | None) -> str:
    return (f"_{{{below}}}" if below else "") + (f"^{{{_spell(upper)}}}" if upper is not None else "")


def _integrated(node: Integrated) -> str:
    limits = _limits(_spell(node.lower) if node.lower is not None else "", node.upper)
    return rf"\int{limits} {_spell(node.body)} \, d {_spell(node.variable)}"


def _matrix(node: Matrix) -> str:
    rows = [" & ".join(map(_spell, row)) for row in node.rows]
    end = r" \\" if not rows[-1] and len(rows) > 1 else ""
    name = ENVIRONMENT[node.fence]
    return rf"\begin{{{name}}} " + r" \\ ".join(rows) + rf"{end} \end{{{name}}}"


def _cases(node: Cases) -> str:
    rows = [f"{_spell(v)} & " + (r"\text{otherwise}" if c is None else _spell(c)) for v, c in node.rows]
    return r"\begin{cases} " + r" \\ ".join(rows) + r" \end{cases}"


def _related(node: Related) -> str:
    text = _spell(node.sides[0])
    for relation, side in zip(node.relations, node.sides[1:], strict=True):
        text += f" {COMMANDS.get(relation, relation)} {_spell(side)}"
    return text.strip()


def _radical(node: Radical) -> str:
    index = f"[{_spell(node.index)}]" if node.index is not None else ""
    return rf"\sqrt{index}{{{_spell(node.body)}}}"


SPELLINGS: Mapping[type[Node], Callable[..., str]] = {
    Name: _name,
    Digits: _digits,
    Infinite: lambda _: r"\infty",
    Blank: lambda node: {"…": r"\dots", "·": r"\cdot", "*": "*", "": ""}[node.mark],
    Plus: _plus,
    Times: _times,
    Over: _over,
    Radical: _radical,
    Raised: lambda node: f"{_base(node.body)}^{{{_spell(node.exponent)}}}",
    Transposed: _transposed,
    Inverted: lambda node: f"{_base(node.body)}^{{-1}}",
    Fenced: _fenced,
    Applied: _applied,
    Called: _called,
    Expected: lambda node: r"\mathbb{E}" + _fence(node.body, "[", "]"),
    Given: lambda node: rf"{_spell(node.body)} \mid {_spell(node.condition)}",
    Differentiated: _differentiated,
    Barred: lambda node: rf"\bar{{{_spell(node.body)}}}",
    Dotted: _dotted,
    Summed: _summed,
    Integrated: _integrated,
    Matrix: _matrix,
    Cases: _cases,
    Listed: _listed,
    Related: _related,
}
