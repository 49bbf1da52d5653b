"""Names and characters of Greek letters, operators and accents, for the printers and the reader."""

from __future__ import annotations

GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ϵ", "varepsilon": "ε", "zeta": "ζ", "eta": "η",
    "theta": "θ", "vartheta": "ϑ", "iota": "ι", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ",
    "pi": "π", "rho": "ρ", "varrho": "ϱ", "sigma": "σ", "varsigma": "ς", "tau": "τ", "upsilon": "υ", "phi": "ϕ",
    "varphi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ", "Delta": "Δ", "Theta": "Θ", "Lambda": "Λ",
    "Xi": "Ξ", "Pi": "Π", "Sigma": "Σ", "Upsilon": "Υ", "Phi": "Φ", "Psi": "Ψ", "Omega": "Ω", "ell": "ℓ",
    "infty": "∞",
}  # fmt: skip

# character -> (TeX, plain text); a character that is missing here stands for itself
SIGNS = {
    "−": ("-", "-"), "+": ("+", "+"), "⋅": (r"\cdot", "*"), "=": ("=", "="), ":=": (":=", ":="),
    "⪰": (r"\succeq", ">="),
    "≻": (r"\succ", ">"), "⪯": (r"\preceq", "<="), "≺": (r"\prec", "<"), "≠": (r"\neq", "!="), "≥": (r"\geq", ">="),
    "≤": (r"\leq", "<="), "→": (r"\to", "->"), "≈": (r"\approx", "~"), "∫": (r"\int", "∫"), "∂": (r"\partial", "∂"),
    "∑": (r"\sum", "∑"), "∏": (r"\prod", "∏"),
    "⊤": (r"\top", "'"), "∗": (r"\ast", "*"), "⋆": (r"\star", "*"), "<": (r"\lt", "<"), ">": (r"\gt", ">"),
}  # fmt: skip

# accent -> (TeX, spacing character for MathML, combining character for plain text)
ACCENTS = {"hat": ("hat", "ˆ", "\u0302"), "bar": ("bar", "¯", "\u0304"), "dot": ("dot", "˙", "\u0307"),
           "tilde": ("tilde", "˜", "\u0303")}  # fmt: skip
