"""The words of the reader: what commands and characters mean, by class."""

from __future__ import annotations

from derive.latex.alphabet import ACCENTS, GREEK


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


LETTERS = frozenset(GREEK) - {"infty"}
LETTER_OF = {char: name for name, char in GREEK.items()}

# command -> sign of the relation in a chain
RELATIONS = {
    "eq": "=", "equiv": "=", "coloneqq": ":=", "coloneq": ":=", "triangleq": ":=", "doteq": ":=", "lt": "<", "gt": ">",
    "le": "≤", "leq": "≤", "leqslant": "≤", "leqq": "≤", "ge": "≥", "geq": "≥", "geqslant": "≥", "geqq": "≥",
    "prec": "≺", "succ": "≻", "preceq": "⪯", "preccurlyeq": "⪯", "succeq": "⪰", "succcurlyeq": "⪰", "ne": "≠",
    "neq": "≠", "to": "→", "rightarrow": "→", "longrightarrow": "→", "in": "∈", "sim": "∼", "approx": "≈",
    "simeq": "≈", "implies": "⇒", "Rightarrow": "⇒", "Longrightarrow": "⇒", "iff": "⇔", "Leftrightarrow": "⇔",
    "Longleftrightarrow": "⇔", "propto": "∝", "ll": "≪", "gg": "≫", "subset": "⊂", "subseteq": "⊆",
}  # fmt: skip

# command -> (bracket, side)
DELIMITERS = {
    "lbrace": ("\\{", ""), "rbrace": ("\\}", ""), "lbrack": ("[", ""), "rbrack": ("]", ""), "lparen": ("(", ""),
    "rparen": (")", ""), "vert": ("|", ""), "lvert": ("|", "left"), "rvert": ("|", "right"), "Vert": ("‖", ""),
    "lVert": ("‖", "left"), "rVert": ("‖", "right"), "mid": ("|", "middle"),
}  # fmt: skip
CLOSING = {"(": ")", "[": "]", "\\{": "\\}", "|": "|", "‖": "‖"}

# size of a bracket -> its side
SIZES = {"left": "left", "right": "right", "middle": "middle"}
SIZES |= {big + end: side for big in ("big", "Big", "bigg", "Bigg") for end, side in (("", ""), ("l", "left"),
          ("r", "right"), ("m", "middle"))}  # fmt: skip

DROPPED = _words(
    "displaystyle textstyle scriptstyle scriptscriptstyle limits nolimits nonumber notag thinspace medspace thickspace "
    "negthinspace negmedspace negthickspace enspace hfill relax allowbreak nobreak mathstrut strut "
    "normalfont centering boldmath unboldmath bf it sf cal tt bfseries itshape small large"
)
DROPPED_WITH_ARGUMENT = _words("hspace vspace mspace phantom vphantom hphantom color")
WIDE = frozenset(("quad", "qquad"))
TEXT = _words("text textrm textnormal textit textbf textsf texttt mbox hbox intertext shortintertext")
RAW = frozenset(("label", "tag"))
STYLES = _words(
    "mathbf boldsymbol bm bold pmb mathit mathsf mathtt mathcal mathscr mathfrak mathnormal symbf symbfit symit "
    "mathbfit mathop mathrel mathbin mathord mathopen mathclose mathpunct ensuremath"
)
ROMAN = frozenset(("mathrm", "operatorname", "mathup", "rm", "symrm", "symup"))
BOXES = frozenset(("boxed", "fbox"))
BRACED = {"underbrace": "_", "overbrace": "^"}
BLACKBOARD = {"R": "ℝ", "C": "ℂ", "N": "ℕ", "Z": "ℤ", "Q": "ℚ", "S": "𝕊", "P": "ℙ", "V": "𝕍", "I": "I", "1": "1"}

ACCENT_COMMANDS = {
    "hat": "hat", "widehat": "hat", "bar": "bar", "overline": "bar", "widebar": "bar", "tilde": "tilde",
    "widetilde": "tilde", "dot": "dot", "ddot": "ddot", "dddot": "dddot", "vec": "vec", "underline": "underline",
    "underbar": "underline", "check": "check", "widecheck": "check", "breve": "breve", "mathring": "ring",
    "overrightarrow": "vec",
}  # fmt: skip
DOTS = {"dot": 1, "ddot": 2, "dddot": 3}
COMBINING = {
    **{name: combining for name, (_, _, combining) in ACCENTS.items()},
    "ddot": "\u0308", "dddot": "\u20db", "vec": "\u20d7", "underline": "\u0332", "check": "\u030c", "breve": "\u0306",
    "ring": "\u030a",
}  # fmt: skip
ACCENT_OF = {combining: name for name, combining in COMBINING.items()}
ACCENT_OF |= {"\u0305": "bar", "\u0331": "underline"}
SPELLED_ACCENT = {"ring": "mathring"}

# functions by what they are called on the page, and the one name that the tree has
FUNCTIONS = {
    **{f: f for f in _words("det tr max min ln log exp sin cos tan cot sinh cosh tanh arctan arcsin arccos diag rank "
                            "lim inf sup arg argmin argmax cov var vec sgn limsup liminf blkdiag spec null span dim")},
    "Re": "Re", "Im": "Im", "real": "Re", "imag": "Im", "trace": "tr", "Tr": "tr", "Trace": "tr", "spur": "tr",
    "Cov": "cov", "Var": "var", "sign": "sgn", "atan": "arctan", "rk": "rank", "ker": "null", "Det": "det",
    "diagonal": "diag", "col": "col",
}  # fmt: skip
OPEN_FUNCTIONS = frozenset(("max", "min", "lim", "inf", "sup", "argmin", "argmax", "limsup", "liminf"))
TRIGONOMETRIC = _words("sin cos tan cot sinh cosh tanh ln log exp")
FUNCTION_COMMANDS = {name: f for name, f in FUNCTIONS.items() if name not in ("real", "imag", "vec", "span", "col")}
# runs of letters that somebody meant as a word and LaTeX sets as a product
UNMARKED = _words("tr det max min ln log exp sin cos tan diag rank lim inf sup sqrt trace inv cov var Tr Cov Var") | {
    name for name in GREEK if name not in ("eta", "chi")
}

TRANSPOSES = {"top": "top", "intercal": "top", "T": "T", "*": "star", "ast": "star", "prime": "prime", "'": "prime",
              "dagger": "dagger", "dag": "dagger", "H": "H"}  # fmt: skip
SIGNS_OF_MULTIPLICATION = frozenset(("cdot", "times", "*", "ast"))
ELLIPSES = _words("dots ldots cdots vdots ddots dotsc dotsb dotsm dotso hdots")
NO_OPERANDS = _words("forall pm mp cdot times ast hline star top overset stackrel not")
FRACTIONS = frozenset(("frac", "dfrac", "tfrac", "cfrac"))
EXPECTATIONS = frozenset(("E", "𝔼"))

LAYOUTS = _words(
    "equation align aligned alignat alignedat split gather gathered multline multlined eqnarray flalign displaymath "
    "math dmath subequations"
)
POSITIONED = frozenset(("aligned", "alignedat", "gathered", "multlined", "array"))
COLUMNED = frozenset(("align", "aligned", "alignat", "alignedat", "flalign"))
MATRICES = {"bmatrix": "[", "pmatrix": "(", "matrix": "", "Bmatrix": "{", "vmatrix": "|", "Vmatrix": "‖",
            "smallmatrix": "", "array": "", "bsmallmatrix": "[", "psmallmatrix": "("}  # fmt: skip

# signs of an index and of a mark above a letter
MARKS = {"infty": "∞", "top": "⊤", "ast": "*", "star": "⋆", "dagger": "†", "circ": "∘", "perp": "⊥", "cdot": "·",
         "prime": "'", "pm": "±", "parallel": "∥", "bullet": "•"}  # fmt: skip

# letters that stand for times, frequencies and indices when they are an argument
MOMENTS = _words("t s z k i j n h T N tau omega sigma theta nu Delta Omega")

# characters beyond ASCII -> LaTeX; letters with accents, styles, scripts and fractions are taken apart by Unicode
CHARACTERS = {
    **{char: "\\" + name + " " for char, name in LETTER_OF.items()},
    "−": "-", "–": "-", "‐": "-", "‑": "-", "⋅": r"\cdot ", "·": r"\cdot ", "∙": r"\cdot ", "×": r"\times ",
    "∗": "*", "±": r"\pm ", "∓": r"\mp ", "≥": r"\ge ", "≤": r"\le ", "⩾": r"\ge ", "⩽": r"\le ", "≠": r"\ne ",
    "⪰": r"\succeq ", "⪯": r"\preceq ", "≽": r"\succeq ", "≼": r"\preceq ", "≻": r"\succ ", "≺": r"\prec ",
    "→": r"\to ", "⟶": r"\to ", "∈": r"\in ", "∼": r"\sim ", "≈": r"\approx ", "≡": r"\equiv ", "≜": r"\triangleq ",
    "≔": r"\coloneqq ", "⇒": r"\implies ", "⟹": r"\implies ", "⇔": r"\iff ", "⟺": r"\iff ", "∝": r"\propto ",
    "∫": r"\int ", "∑": r"\sum ", "∏": r"\prod ", "∂": r"\partial ", "√": r"\sqrt ", "∞": r"\infty ",
    "⊤": r"\top ", "⊺": r"\top ", "†": r"\dagger ", "′": "'", "’": "'", "″": "''", "…": r"\dots ", "⋯": r"\dots ",
    "⋮": r"\dots ", "⋱": r"\dots ", "‖": r"\Vert ", "∥": r"\Vert ", "∣": r"\mid ", "∀": r"\forall ", "ℜ": r"\Re ",
    "ℑ": r"\Im ", "∆": r"\Delta ", "µ": r"\mu ", "⋆": r"\star ", "★": r"\star ", "𝔼": r"\mathbb{E}",
    "≪": r"\ll ", "≫": r"\gg ", "⊂": r"\subset ", "⊆": r"\subseteq ",
}  # fmt: skip
