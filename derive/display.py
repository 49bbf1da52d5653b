"""How terms, equations, steps and lectures show themselves: as LaTeX, as text, as SymPy, in a notebook.

What does the printing is imported when it is asked for. Only a lecture shows verdicts, since only a lecture can be
replayed; a step by itself shows what it states and why.
"""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from derive.terms import Equation, Term

__all__ = ["Displayed"]

PAGE = '<iframe srcdoc="{}" title="{}" style="width:100%;height:40rem;border:0"></iframe>'


class Displayed:
    """Mixin for what states formulas: .latex(), .sympy, str(), and the display of notebooks.

    >>> import derive
    >>> print(derive.luenberger.steady_gain())
    L = A P C' (C P C' + R)^-1
    """

    __slots__ = ()

    def latex(self) -> str:
        """Return LaTeX for math mode: a formula, or several one under the other."""
        from derive.latex import latex

        lines = [latex(formula) for formula in formulas(self)]
        return lines[0] if len(lines) == 1 else "\\begin{gathered}\n" + " \\\\\n".join(lines) + "\n\\end{gathered}"

    @property
    def sympy(self) -> Any:
        """The formula as a SymPy expression; of a lecture or chain, the tuple of its equations.

        Raises:
            InputError: an inequality, since SymPy has no order of symmetric matrices.
        """
        from derive.export import to_sympy

        found = formulas(self)
        if len(found) == 1:
            return to_sympy(found[0])
        return tuple(to_sympy(f) for f in found if getattr(f, "relation", "=") in ("=", ":="))

    def __str__(self) -> str:
        from derive.latex import plain

        return "\n".join(map(plain, formulas(self)))

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex()}$"

    def _repr_html_(self) -> str:
        from derive.derivation import Derived, Lecture, Step
        from derive.latex import mathml

        match self:
            case Lecture():
                return _page(self)
            case Derived(steps):
                return "".join(step._repr_html_() for step in steps if step.rule != "chain" or len(steps) == 1)
            case Step(statement=statement, reason=reason):
                parts = (escape(part) if isinstance(part, str) else mathml(part) for part in reason)
                return f"{mathml(statement, display=True)}<p>{''.join(parts)}</p>"
            case _:
                return "".join(mathml(formula, display=True) for formula in formulas(self))


def formulas(item: Any) -> tuple[Term | Equation, ...]:
    """Return what something states: a term or equation itself, a step its statement, a lecture those of its steps."""
    from derive.derivation import Derived, Lecture, Step

    match item:
        case Lecture() | Derived():
            return tuple(step.statement for step in item.steps)
        case Step(statement=statement):
            return (statement,)
        case _:
            return (item,)


def _page(lecture: Any) -> str:
    """Return the notes of a lecture, replayed now, in a frame that keeps their style to themselves."""
    from derive.notes.html import html
    from derive.notes.model import document_of

    return PAGE.format(escape(html(document_of(lecture, lecture.verify()))), escape(lecture.title))
