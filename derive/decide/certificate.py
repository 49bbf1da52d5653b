"""Certificates of claims as JSON, and their replay from the installed theory.

A file brings its LaTeX, names and addends. What the LaTeX means, the relations and the hypotheses come from the
installed theory; the inverses of the claim are established again, and everything that the file shows is compared with
what the replay writes, so that no field can be changed.

Schema derive-certificate/1: theory, latex, assume, scalar, symbols, relations (names); lemmas and inverses, in order,
under ``steps``; for one identity its claim, terms and trace, otherwise ``parts``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from derive.claim import Claim
from derive.decide.ground import Introduced, Item, Lemma, accept, symbols
from derive.decide.hypotheses import addends_in, addends_of
from derive.decide.parts import Part, bound, replay_part
from derive.decide.traces import TraceOrder, TraceProduct
from derive.decide.workspace import proof_reading
from derive.derivation import Proof
from derive.errors import InputError
from derive.interpret.statement import Statement
from derive.kernel import Poly, Rejected
from derive.kernel import Term as Addend
from derive.kernel import parts as letter_parts
from derive.rules import Grid
from derive.serialise import SCHEMAS, Reader, certificates, letters, to_json
from derive.terms import Equation, Reading, Symbol, walk
from derive.wellformed import EXPANSION, a_dict, a_list, shown

__all__ = ["SCHEMA", "certificate", "replay_claim", "replayed", "signed"]

SCHEMA = SCHEMAS["identities"]
FIRST = ("schema", "theory", "latex", "assume", "scalar", "symbols", "relations", "steps")
ONE = ("claim", "terms", "trace")


def replayed(statement: Statement, items: Sequence[Item], proof: Sequence[Part]) -> Reading:
    """Replay the proof of a statement from its theory, and return the reading with all that it establishes.

    Raises:
        Rejected: something in it does not hold.
    """
    reading = accept(items, proof_reading(statement.theory, statement.equations), statement.theory.theory)
    if len(proof) != len(statement.equations):
        raise Rejected("every equation of the claim needs its proof")
    for part, equation in zip(proof, statement.equations, strict=True):
        replay_part(part, equation, reading, statement.theory)
    return reading


# ------------------------------------------------------------------------------------------------ writing
def certificate(statement: Statement, items: Sequence[Item], proof: Sequence[Part]) -> dict[str, Any]:
    """Return the certificate of a statement, without the text it was read from."""
    theory = symbols(items, statement.theory.theory, statement.equations)
    steps, shown_parts = [_item(item, theory) for item in items], [_part(part, theory) for part in proof]
    body: dict[str, Any] = {"steps": steps, "parts": shown_parts}
    if len(proof) == 1 and len(proof[0].proof.identities) == 1:
        rule, one = proof[0].rule, shown_parts[0]["certificates"][0]
        body = {"steps": steps, "rule": rule, **{key: one[key] for key in ONE}}
    used = {r for part in shown_parts for r in part["relations"]} | {r for step in steps for r in step["relations"]}
    named = {letter_parts(letter)[0] for letter in letters(body)}
    named |= {n.name for e in statement.equations for n in _symbols(e)}
    return {
        "schema": SCHEMA,
        "theory": statement.theory.key,
        "latex": "",
        "assume": [],
        "scalar": statement.scalar,
        "symbols": sorted(named & set(statement.theory.theory.symbols)),
        "relations": sorted(used),
        **body,
    }


def signed(data: Mapping[str, Any], claim: Claim) -> dict[str, Any]:
    """Return the certificate with the text of the claim that it belongs to."""
    return {**data, "latex": claim.latex, "assume": list(claim.assume)}


def _symbols(equation: Equation) -> list[Symbol]:
    return [n for side in (equation.lhs, equation.rhs) for n in walk(side) if isinstance(n, Symbol)]


def _item(item: Item, theory: Any) -> dict[str, Any]:
    if isinstance(item, Lemma):
        proof = Proof(positivity=item.positivity, comparison=item.comparison)
        (shown_proof,) = certificates(proof, theory)
        return {
            "fact": item.name,
            "kind": item.kind,
            "matrix": to_json(item.matrix, theory),
            "relations": shown_proof["relations"],
            "certificate": shown_proof,
        }
    reason = {"because": item.because, "generic": item.generic, "by": None, "right": [], "left": []}
    if item.by is not None:
        reason |= {"by": to_json(item.by, theory)}
        reason |= {"right": to_json(item.right, theory), "left": to_json(item.left, theory)}
    used = {t.relation for t in item.right + item.left} | ({item.because} - {""})
    return {"inverse": item.letter, "of": to_json(item.of, theory), "relations": sorted(used), **reason}


def _part(part: Part, theory: Any) -> dict[str, Any]:
    if part.order is not None:
        names = {t.relation for t in part.order.terms}
        names |= {name for p in part.order.products for name in (p.one, p.two)}
        return {"rule": part.rule, "relations": sorted(names), "order": to_json(part.order, theory)}
    shown_proofs = certificates(part.proof, theory)
    image = {} if part.image is None else {"image": to_json(part.image, theory)}
    return {
        **image,
        "rule": part.rule,
        "relations": sorted({r for c in shown_proofs for r in c["relations"]}),
        "certificates": shown_proofs,
    }


# ------------------------------------------------------------------------------------------------ reading
def replay_claim(data: Any) -> None:
    """Replay the certificate of a claim, or raise Rejected.

    The LaTeX is read again in the installed theory, the lemmas and inverses are accepted in order, the proof of every
    equation is replayed, and the certificate is written again: it has to be the one in the file.

    Raises:
        InputError: it is not well-formed.
        Rejected: it does not prove what it says.
    """
    item = a_dict(data, "certificate")
    if "proof" in item:
        _replay_numbers(item)
        return
    if "lecture" in item:
        _replay_theorems(item)
        return
    missing = sorted(set(FIRST) - set(item))
    if missing:
        raise InputError(f"certificate: expected the keys {', '.join(FIRST)}, got none of the name {missing[0]}")
    statement, claim = _statement(item)
    for equation in statement.equations:
        bound(equation, statement.theory)
    theory = statement.theory.theory
    items: list[Item] = []
    for step in a_list(item["steps"], "steps"):
        items.append(_read_item(step, Reader(symbols(items, theory, statement.equations))))
    reader = Reader(symbols(items, theory, statement.equations))
    proof = _read_parts(item, reader)
    try:
        _check_plain(items, proof, replayed(statement, items, proof))
    except (ValueError, IndexError, KeyError) as error:
        raise Rejected(str(error)) from error
    again = signed(certificate(statement, items, proof), claim)
    wrong = [key for key in {*again, *item} if key not in again or key not in item or again[key] != item[key]]
    if wrong:
        raise Rejected(f"the file shows another {sorted(wrong)[0]} than its own")


def _check_plain(items: Sequence[Item], proof: Sequence[Part], reading: Reading) -> None:
    """Reject the transpose of a relation that is its own: an addend is written in one way."""
    context = reading.context
    for addend in [t for item in items for t in addends_of(item)] + addends_in(proof):
        relation = context.relations[addend.relation]
        if addend.transposed and context.alphabet.transpose(relation) in (relation, -relation):
            raise Rejected(f"{addend.relation} is its own transpose")


def _replay_numbers(item: Mapping[str, Any]) -> None:
    """Replay the certificate of a claim about numbers."""
    from derive.scalar.proof_file import replay_numbers

    if not {"latex", "assume", "scalar", "theory"} <= set(item):
        raise InputError("certificate: expected the keys latex, assume, scalar and theory, got fewer")
    statement, _ = _statement(item)
    replay_numbers(item, statement)


def _replay_theorems(item: Mapping[str, Any]) -> None:
    """Replay the certificate of a claim that the theorems of a lecture show."""
    from derive.decide.spectra.decision import replay_theorems

    if not {"latex", "assume", "scalar", "theory"} <= set(item):
        raise InputError("certificate: expected the keys latex, assume, scalar and theory, got fewer")
    statement, _ = _statement(item)
    replay_theorems(item, statement)


def _statement(item: Mapping[str, Any]) -> tuple[Statement, Claim]:
    """Read the claim's LaTeX in the installed theory."""
    from derive.interpret import understand
    from derive.latex.grammar import read
    from derive.theory.claims import claim_theory

    latex, assume = item["latex"], a_list(item["assume"], "assume")
    if not isinstance(latex, str) or not all(isinstance(a, str) for a in assume):
        raise InputError("latex, assume: expected texts, got something else")
    if not isinstance(item["scalar"], bool) or not isinstance(item["theory"], str):
        raise InputError(f"theory: expected a name, and true or false for scalar, got {shown(item['theory'])}")
    theory = claim_theory(item["theory"])
    given = [read(a) for a in assume]
    statement = understand(read(latex), theory, assume=given, scalar=item["scalar"])
    return statement, Claim(latex, item["theory"], tuple(assume), item["scalar"])


def _read_item(data: Any, reader: Reader) -> Item:
    item = a_dict(data, "steps")
    if "fact" in item:
        a_dict(data, "steps", ("fact", "kind", "matrix", "relations", "certificate"))
        proof = reader.proof([item["certificate"]])
        if (proof.positivity is None) == (proof.comparison is None):
            raise InputError("certificate: expected one of positivity or comparison, got another")
        matrix = reader.read(Grid, item["matrix"], "matrix")
        return Lemma(_text(item["fact"]), _text(item["kind"]), matrix, proof.positivity, proof.comparison)
    a_dict(data, "steps", ("inverse", "of", "relations", "because", "generic", "by", "right", "left"))
    of, by = reader.read(Poly, item["of"], "of"), item["by"]
    explicit = None if by is None else reader.read(Poly, by, "by")
    if explicit is not None and len(of.terms) * len(explicit.terms) > EXPANSION:
        raise InputError(f"by: expected a formula that expands to at most {EXPANSION} products, got more")
    right, left = _addends(item["right"], reader), _addends(item["left"], reader)
    because, generic = _text(item["because"]), _text(item["generic"])
    return Introduced(_text(item["inverse"]), of, because, explicit, right, left, generic)


def _read_parts(item: Mapping[str, Any], reader: Reader) -> list[Part]:
    if "parts" not in item:
        a_dict(item, "certificate", (*FIRST, "rule", *ONE))
        name, body = reader.certificate({"schema": SCHEMA, "theory": reader.theory.key, **{k: item[k] for k in ONE}})
        return [Part(_text(item["rule"]), Proof(**{name: (body,)}))]  # type: ignore[arg-type]
    a_dict(item, "certificate", (*FIRST, "parts"))
    found: list[Part] = []
    for data in a_list(item["parts"], "parts"):
        part = a_dict(data, "parts")
        if "order" in part:
            a_dict(part, "parts", ("rule", "relations", "order"))
            found.append(Part(_text(part["rule"]), order=_read_order(part["order"], reader)))  # type: ignore[arg-type]
        else:
            extra = ("image",) if "image" in part else ()
            a_dict(part, "parts", ("rule", "relations", "certificates", *extra))
            image = reader.read(Poly, part["image"], "image") if extra else None
            proof = reader.proof(part["certificates"])
            found.append(Part(_text(part["rule"]), proof, image=image))  # type: ignore[arg-type]
    return found


def _read_order(data: Any, reader: Reader) -> TraceOrder:
    item = a_dict(data, "order", ("products", "terms"))
    products: list[TraceProduct] = []
    for product in a_list(item["products"], "products"):
        one = a_dict(product, "products", ("coefficient", "one", "two"))
        from fractions import Fraction

        number = reader.read(Fraction, one["coefficient"], "coefficient")
        products.append(TraceProduct(number, _text(one["one"]), _text(one["two"])))
    return TraceOrder(tuple(products), _addends(item["terms"], reader))


def _addends(data: Any, reader: Reader) -> tuple[Addend, ...]:
    return tuple(reader.read(Addend, item, "terms") for item in a_list(data, "terms"))


def _text(value: Any) -> str:
    if not isinstance(value, str) or len(value) > 1000:
        raise InputError(f"certificate: expected a name, got {shown(value)}")
    return value
