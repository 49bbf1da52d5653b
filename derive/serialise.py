"""Derivations as JSON and back.

A file carries names, trees and certificates. Symbols, relations and hypotheses are looked up in the installed theory:
no file brings its own. What is read is checked for type, names, depth and the size of what it expands to, so that the
kernel is handed well-formed objects only. Standard library only.

A symbol is written by its name, ``"A"``, at other times ``"Phi@t,τ"``; every other term is a list that starts with
its kind, ``["Sum", ["A", ["Neg", "B"]]]``. Rational numbers are "p/q".
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from fractions import Fraction
from functools import cache
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from derive import analysis, derivation, induction, kernel, real, rules, spectral, terms
from derive.context import Theory
from derive.derivation import Proof, Step
from derive.errors import InputError
from derive.kernel import Certificate, Poly
from derive.terms import Equation, Symbol, Term
from derive.wellformed import CHECKS, LENGTH, a_dict, a_list, check_time, check_work, expansion, shown

DEPTH = 64  # nesting of terms
NODES: Mapping[str, type[Term]] = {
    cls.__name__: cls
    for cls in (*vars(terms).values(), *vars(analysis).values(), *vars(spectral).values())
    if isinstance(cls, type) and issubclass(cls, Term) and cls != Term
}
SCHEMAS: Mapping[str, str] = {
    "identities": "derive-certificate/1",
    "positivity": "derive-positivity/1",
    "comparison": "derive-comparison/1",
    "uniqueness": "derive-uniqueness/1",
    "links": "derive-chain/1",
    "sign": "derive-sign/1",
    "induction": "derive-induction/1",
}
RATIONAL = re.compile(r"-?[0-9]{1,400}(/[1-9][0-9]{0,399})?")
T = TypeVar("T")


# ------------------------------------------------------------------------------------------------ writing
def to_json(value: Any, theory: Theory) -> Any:
    """Return terms, equations, polynomials, certificates and tuples of them as lists, dicts and texts."""
    match value:
        case None | bool() | int() | str():
            return value
        case Fraction():
            return str(value)
        case Symbol():
            declared = theory.symbols.get(value.name)
            plain = declared and (declared.args, declared.show_args) == (value.args, value.show_args)
            return value.name if plain else value.letter
        case Term():
            return [type(value).__name__, *(to_json(getattr(value, f.name), theory) for f in fields(value))]  # type: ignore[arg-type]
        case Poly():
            addends = [
                {"coefficient": str(c), "scalars": list(m), "word": list(w)} for (m, w), c in value.terms.items()
            ]
            return {"rows": value.rows, "cols": value.cols, "terms": addends}
        case tuple():
            return [to_json(v, theory) for v in value]
        case _:
            return {f.name: to_json(getattr(value, f.name), theory) for f in fields(value)}


def certificates(proof: Proof, theory: Theory) -> list[dict[str, Any]]:
    """Return the certificates of a proof, each with its schema, its theory and the names it uses."""
    out: list[dict[str, Any]] = []
    for name, schema in SCHEMAS.items():
        value = getattr(proof, name)
        for part in value if name == "identities" else [value] if value else []:
            body = {"links": list(part)} if name == "links" else to_json(part, theory)
            alone: dict[str, Any] = {name: (part,) if name == "identities" else part}
            out.append({
                "schema": schema,
                "theory": theory.key,
                "symbols": sorted({kernel.parts(letter)[0] for letter in letters(body)} & set(theory.symbols)),
                "relations": sorted(Proof(**alone).relations()),
                **body,
            })  # fmt: skip
    return out


def letters(data: Any, key: str = "") -> Iterator[str]:
    """Iterate over the letters and scalars in the words of a certificate written as JSON."""
    if isinstance(data, str) and key in ("word", "left", "right", "scalars"):
        yield data
    elif isinstance(data, dict):
        for name, value in data.items():
            yield from letters(value, name)
    elif isinstance(data, list):
        for value in data:
            yield from letters(value, key)


# ------------------------------------------------------------------------------------------------ reading
@dataclass(frozen=True)
class Reader:
    """Reads JSON data into objects over one theory; everything malformed raises InputError."""

    theory: Theory

    def equation(self, data: Any) -> Equation:
        """Read a statement, and bound what it expands to."""
        statement = self.read(Equation, data, "statement")
        for side in (statement.lhs, statement.rhs):
            expansion(side, self.theory)
        return statement

    def proof(self, data: Any) -> Proof:
        """Read the certificates of a step."""
        found: dict[str, Any] = {"identities": ()}
        for item in a_list(data, "certificates"):
            name, part = self.certificate(item)
            if name in found and name != "identities":
                raise InputError(f"certificates: expected one of schema {SCHEMAS[name]}, got two; keep one")
            found[name] = (*found["identities"], part) if name == "identities" else part
        proof = Proof(**found)
        check_work(proof)
        return proof

    def certificate(self, data: Any) -> tuple[str, Any]:
        """Read one certificate; returns the field of Proof that it belongs to, and the object."""
        item = a_dict(data, "certificate")
        name = {schema: name for name, schema in SCHEMAS.items()}.get(str(item.get("schema")))
        if name is None:
            raise InputError(f"schema: expected one of {', '.join(SCHEMAS.values())}, got {shown(item.get('schema'))}")
        if item.get("theory") != self.theory.key:
            raise InputError(f"theory: expected {self.theory.key!r}, got {shown(item.get('theory'))}")
        body = {k: v for k, v in item.items() if k not in ("schema", "theory", "symbols", "relations")}
        if name == "links":
            return name, self.read(tuple[str, ...], body.get("links"), "links")
        kind = Certificate if name == "identities" else next(
            k for k in get_args(hints(Proof)[name]) if k is not type(None)
        )  # fmt: skip
        return name, self.read(kind, body, "certificate")

    def read(self, kind: type[T], data: Any, name: str, depth: int = 0) -> T:
        """Read data as a value of the given type; ``name`` is the field it fills."""
        return self._read(kind, data, name, depth)

    def _read(self, kind: Any, data: Any, name: str, depth: int) -> Any:
        if depth > DEPTH:
            raise InputError(f"{name}: expected at most {DEPTH} levels of nesting; write it in smaller steps")
        origin, arguments = get_origin(kind), get_args(kind)
        if origin is tuple:
            if name in ("word", "left", "right", "scalars") and len(a_list(data, name)) > LENGTH:
                raise InputError(f"{name}: expected at most {LENGTH} letters, got {len(data)}")
            return tuple(self._read(arguments[0], item, name, depth + 1) for item in a_list(data, name))
        if origin is Literal:
            if data not in arguments or not isinstance(data, str):
                raise InputError(f"{name}: expected one of {', '.join(arguments)}, got {shown(data)}")
            return data
        if type(None) in arguments:
            return None if data is None else self._read(arguments[0], data, name, depth)
        if kind is Poly:
            return self._poly(data, name)
        if isinstance(kind, type) and issubclass(kind, Term):
            return self._term(kind, data, name, depth)
        if is_dataclass(kind):
            item = a_dict(data, name, [f.name for f in fields(kind)])
            values = {f.name: self._read(hints(kind)[f.name], item[f.name], f.name, depth + 1) for f in fields(kind)}
            return kind(**values)  # type: ignore[call-arg]
        return self._leaf(kind, data, name)

    def _leaf(self, kind: type, data: Any, name: str) -> Any:
        if kind is Fraction:
            if not isinstance(data, str) or not RATIONAL.fullmatch(data):
                raise InputError(f'{name}: expected a rational number "p/q", got {shown(data)}')
            return Fraction(data)
        if type(data) is not kind or (isinstance(data, str) and len(data) > 20_000):
            raise InputError(f"{name}: expected {kind.__name__}, got {shown(data)}")
        if isinstance(data, str) and not data.isprintable():
            raise InputError(f"{name}: expected text without control characters, got {data[:40]!a}")
        if isinstance(data, str) and name in CHECKS:
            CHECKS[name](self.theory, data)
        return data

    def _poly(self, data: Any, name: str) -> Poly:
        item, found = a_dict(data, name, ("rows", "cols", "terms")), dict[kernel.Key, Fraction]()
        for addend in a_list(item["terms"], "terms"):
            part = a_dict(addend, "terms", ("coefficient", "scalars", "word"))
            key = (
                self._read(tuple[str, ...], part["scalars"], "scalars", 0),
                self._read(tuple[str, ...], part["word"], "word", 0),
            )
            if key in found or list(key[0]) != sorted(key[0]):
                raise InputError(f"terms: expected each product once, its scalars sorted, got {shown(addend)}")
            found[key] = self._leaf(Fraction, part["coefficient"], "coefficient")
        return Poly(found, self._leaf(str, item["rows"], "rows"), self._leaf(str, item["cols"], "cols"))

    def _term(self, kind: type[Term], data: Any, name: str, depth: int) -> Term:
        if isinstance(data, str):
            return self._symbol(data)
        head, *rest = a_list(data, name) or [None]
        cls = NODES.get(head) if isinstance(head, str) else None
        if cls is None or not issubclass(cls, kind) or cls is Symbol or len(rest) != len(fields(cls)):  # type: ignore[arg-type]
            raise InputError(f"{name}: expected a symbol or [kind, ...] as in the documentation, got {shown(data)}")
        values = [
            self._read(hints(cls)[f.name], value, f.name, depth + 1)
            for f, value in zip(fields(cls), rest, strict=True)  # type: ignore[arg-type]
        ]
        if any(isinstance(value, tuple) and (not value or not all(value)) for value in values):
            raise InputError(f"{name}: expected at least one term in {head}, got none")
        return cls(*values)

    def _symbol(self, text: str) -> Symbol:
        name, sign, arguments = text.partition("@")
        if name not in self.theory.symbols:
            raise InputError(f"{shown(text)}: not a symbol of the theory {self.theory.key}")
        if not sign:
            return self.theory.symbols[name]
        if self.theory.symbols[name].scalar or name in self.theory.constant:
            raise InputError(f"{shown(text)}: {name} does not depend on time; leave out the arguments")
        for time in arguments.split(","):
            check_time(self.theory, time)
        return self.theory.symbols[name].at(*arguments.split(","))


@cache
def hints(cls: type) -> dict[str, Any]:
    """Return the resolved types of a dataclass's fields."""
    modules = terms, analysis, spectral, real, rules, induction, derivation, kernel
    names = {name: item for module in modules for name, item in vars(module).items()}
    return get_type_hints(cls, {**names, **vars(next(m for m in modules if m.__name__ == cls.__module__))})


def step_to_json(step: Step, theory: Theory, latex: str, reason: str) -> dict[str, Any]:
    """Return a step with its certificates; ``latex`` and ``reason`` are what a reader is shown."""
    return {
        "name": step.name,
        "statement": to_json(step.statement, theory),
        "latex": latex,
        "rule": step.rule,
        "reason": reason,
        "uses": list(step.uses),
        "number": step.number,
        "source": step.source,
        "lemma": step.lemma,
        "certificates": certificates(step.proof, theory),
    }


STEP_KEYS = ("name", "statement", "latex", "rule", "reason", "uses", "number", "source", "lemma", "certificates")


def step_from_json(data: Any, reader: Reader) -> Step:
    """Read a step; its reason becomes plain text."""
    item = a_dict(data, "step", STEP_KEYS)
    plain = {
        name: reader.read(kind, item[name], name) for name, kind in hints(Step).items()
        if name not in ("statement", "reason", "proof")
    }  # fmt: skip
    reason = reader.read(str, item["reason"], "reason")
    reader.read(str, item["latex"], "latex")
    return Step(
        statement=reader.equation(item["statement"]),
        reason=(reason,) if reason else (),
        proof=reader.proof(item["certificates"]),
        **plain,
    )
