"""Proofs about real numbers as JSON and back; what is read is checked for its shape, and replayed by proof.py."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from derive.errors import InputError
from derive.interpret.statement import Statement
from derive.kernel import ANY, Poly, Rejected
from derive.kernel import Term as Addend
from derive.real import NEGATION, Sign, SignProduct
from derive.scalar.evolution import evolution
from derive.scalar.proof import Either, Factor, Leaf, Proof, Reason, Square, Step, Tree, Turned, accept, leaves, plain
from derive.scalar.reasons import letters_of
from derive.serialise import RATIONAL, SCHEMAS

__all__ = ["RULE", "certificate", "proof_from_json", "proof_to_json", "replay_numbers"]

RULE = "sign argument"
KEYS = ("schema", "theory", "latex", "assume", "scalar", "symbols", "relations", "rule", "proof")

DEPTH, LENGTH, SIZE = 16, 200, 5_000  # nesting, letters of a product, entries of a list


# ---------------------------------------------------------------------------------------------- certificates
def certificate(statement: Statement, proof: Proof) -> dict[str, Any]:
    """Return the certificate of a statement about numbers, without the text it was read from."""
    facts = {name for leaf in leaves(proof) for step in leaf.steps for name in _facts(step)}
    return {
        "schema": SCHEMAS["identities"],
        "theory": statement.theory.key,
        "latex": "",
        "assume": [],
        "scalar": statement.scalar,
        "symbols": sorted(letters_of(statement)),
        "relations": sorted(facts),
        "rule": RULE,
        "proof": proof_to_json(proof),
    }


def replay_numbers(data: Any, statement: Statement) -> None:
    """Replay the certificate of a statement about numbers; ``statement`` is what its LaTeX says in its theory.

    Raises:
        InputError: it is not well-formed.
        Rejected: it does not prove the statement, or shows something else than its own.
    """
    item = _dict(data, 0)
    solution = evolution(statement)
    more = {"evolution": True} if solution is not None else {}
    _keys(item, *KEYS, *more)
    proof = proof_from_json(item["proof"])
    accept(solution or statement, proof)
    again = {**certificate(statement, proof), **more, "latex": item["latex"], "assume": item["assume"]}
    wrong = sorted(key for key in again if again[key] != item[key])
    if wrong:
        raise Rejected(f"the file shows another {wrong[0]} than its own")


def _facts(step: Step) -> Iterator[str]:
    match step:
        case Turned(reason=reason):
            yield from _facts(reason)
        case Reason(factors=factors, sign=sign):
            if sign is not None:
                yield from (name for p in sign.products for name in p.facts if name != NEGATION)
                yield from (t.relation for t in sign.terms if t.relation != NEGATION)
            yield from (name for f in factors if f.reason is not None for name in _facts(f.reason))
        case _:
            return


# ---------------------------------------------------------------------------------------------- writing
def proof_to_json(tree: Proof) -> dict[str, Any]:
    """Return a proof as nested dicts and lists."""
    if isinstance(tree, Tree):
        return {"case": _poly(tree.poly), "above": proof_to_json(tree.above), "below": proof_to_json(tree.below)}
    if isinstance(tree, Either):
        return {"alternatives": tree.number, "proofs": [proof_to_json(p) for p in tree.proofs]}
    return {"impossible": True} if tree.impossible else {"steps": [_step(s) for s in tree.steps]}


def _poly(poly: Poly) -> list[list[Any]]:
    return [[str(c), list(m)] for (m, _), c in sorted(poly.terms.items())]


def _step(step: Step) -> dict[str, Any]:
    match step:
        case Square(q, s):
            return {"square": _poly(q), "rest": _poly(s)}
        case Turned(sign, reason):
            return {"turned": sign, **_reason(reason)}
        case _:
            return _reason(step)


def _reason(reason: Reason) -> dict[str, Any]:
    found: dict[str, Any] = {"rule": reason.rule}
    if reason.rule == "apart":
        found["factors"] = [_factor(f) for f in reason.factors]
    if reason.rule == "product":
        found |= {"number": str(reason.number), "factors": [_factor(f) for f in reason.factors]}
    if reason.sign is not None:
        found |= {"relation": reason.sign.relation, "claim": _poly(reason.sign.claim)}
        found["products"] = [
            {"coefficient": str(p.coefficient), "facts": list(p.facts), "squares": [_poly(q) for q in p.squares]}
            for p in reason.sign.products
        ]
        found["terms"] = [[str(t.coefficient), list(t.scalars), t.relation] for t in reason.sign.terms]
    return found


def _factor(factor: Factor) -> dict[str, Any]:
    found = {"factor": _poly(factor.poly), "power": factor.power, "sign": factor.sign}
    return found if factor.reason is None else {**found, "reason": _reason(factor.reason)}


# ---------------------------------------------------------------------------------------------- reading
def proof_from_json(data: Any, depth: int = 0) -> Proof:
    """Read a proof.

    Raises:
        InputError: it is not well-formed.
    """
    item = _dict(data, depth)
    if "case" in item:
        _keys(item, "case", "above", "below")
        below = (proof_from_json(item[k], depth + 1) for k in ("above", "below"))
        return Tree(_written(item["case"]), *below)
    if "alternatives" in item:
        _keys(item, "alternatives", "proofs")
        proofs = tuple(proof_from_json(p, depth + 1) for p in _list(item["proofs"], DEPTH))
        return Either(_whole(item["alternatives"]), proofs)
    if "impossible" in item:
        _keys(item, "impossible")
        return Leaf(impossible=True)
    _keys(item, "steps")
    return Leaf(tuple(_read_step(s) for s in _list(item["steps"])))


def _read_step(data: Any) -> Step:
    item = _dict(data, 0)
    if "square" in item:
        _keys(item, "square", "rest")
        return Square(_read_poly(item["square"]), _read_poly(item["rest"]))
    if "turned" in item:
        rest = {k: v for k, v in item.items() if k != "turned"}
        return Turned(_whole(item["turned"]), _read_reason(rest, 0))
    return _read_reason(item, 0)


def _read_reason(data: Any, depth: int) -> Reason:
    item = _dict(data, depth)
    match item.get("rule"):
        case "known":
            _keys(item, "rule")
            return Reason("known")
        case "product":
            _keys(item, "rule", "number", "factors")
            factors = tuple(_read_factor(f, depth + 1) for f in _list(item["factors"]))
            return Reason("product", _number(item["number"]), factors)
        case "apart":
            _keys(item, "rule", "factors")
            return Reason("apart", factors=tuple(_read_factor(f, depth + 1) for f in _list(item["factors"], 1, 1)))
        case "sign":
            _keys(item, "rule", "relation", "claim", "products", "terms")
            products = tuple(_read_product(p) for p in _list(item["products"]))
            terms = tuple(_read_term(t) for t in _list(item["terms"]))
            return Reason("sign", sign=Sign(_read_poly(item["claim"]), _text(item["relation"]), products, terms))
        case _:
            raise InputError(f"rule: expected known, product or sign, got {str(item.get('rule'))[:40]!r}")


def _read_factor(data: Any, depth: int) -> Factor:
    item = _dict(data, depth)
    reason = _read_reason(item["reason"], depth + 1) if "reason" in item else None
    _keys(item, "factor", "power", "sign", *(("reason",) if reason else ()))
    power = _whole(item["power"])
    if not 1 <= power <= LENGTH:
        raise InputError(f"power: expected 1 to {LENGTH}, got {power}")
    return Factor(_written(item["factor"]), power, _whole(item["sign"]), reason)


def _read_product(data: Any) -> SignProduct:
    item = _dict(data, 0)
    _keys(item, "coefficient", "facts", "squares")
    facts = tuple(_text(f) for f in _list(item["facts"], LENGTH))
    squares = tuple(_written(q) for q in _list(item["squares"], LENGTH))
    return SignProduct(_number(item["coefficient"]), facts, squares)


def _read_term(data: Any) -> Addend:
    number, names, relation = _list(data, 3, 3)
    return Addend(_number(number), _product(names), (), _text(relation), False, ())


def _read_poly(data: Any) -> Poly:
    terms: dict[Any, Fraction] = {}
    for entry in _list(data):
        number, names = _list(entry, 2, 2)
        terms[_product(names), ()] = _number(number)
    return Poly(terms, ANY, ANY)


def _written(data: Any) -> Poly:
    """Read a polynomial of which only a multiple matters, and which is written in one way."""
    poly = _read_poly(data)
    if plain(poly) != poly:
        raise InputError("polynomial: expected whole coefficients without common factor, the first positive")
    return poly


def _product(data: Any) -> tuple[str, ...]:
    names = tuple(_text(n) for n in _list(data, LENGTH))
    if list(names) != sorted(names) or any(n[:1] in ("∫", "δ", "") for n in names):
        raise InputError("product: expected letters in order, got something else")
    return names


def _number(data: Any) -> Fraction:
    if not isinstance(data, str) or not RATIONAL.fullmatch(data):
        raise InputError(f"number: expected p/q as text, got {str(data)[:40]!r}")
    return Fraction(data)


def _whole(data: Any) -> int:
    if type(data) is not int:
        raise InputError(f"number: expected a whole number, got {str(data)[:40]!r}")
    return data


def _text(data: Any) -> str:
    if not isinstance(data, str) or len(data) > 1000:
        raise InputError(f"name: expected a text, got {str(data)[:40]!r}")
    return data


def _list(data: Any, most: int = SIZE, least: int = 0) -> list[Any]:
    if not isinstance(data, list) or not least <= len(data) <= most:
        raise InputError(f"proof: expected a list of {least} to {most} entries, got {str(data)[:40]!r}")
    return data


def _dict(data: Any, depth: int) -> dict[str, Any]:
    if not isinstance(data, dict) or depth > DEPTH:
        raise InputError(f"proof: expected an object, at most {DEPTH} deep, got {str(data)[:40]!r}")
    return data


def _keys(item: dict[str, Any], *wanted: str) -> None:
    if set(item) != set(wanted):
        raise InputError(f"proof: expected the keys {', '.join(wanted)}, got {', '.join(map(str, item))[:80]}")
