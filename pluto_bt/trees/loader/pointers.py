"""`{key}`: when the value of an attribute names an entry instead of being one."""

from __future__ import annotations


def key_of(port: str, value: str) -> str | None:
    """The key that a port's value names, None for a literal. `{=}` and `=` mean the port's own name.

    Blanks outside the braces are passed over, blanks inside belong to the key; `{}` is a literal.
    """
    if value in ("{=}", "="):
        return port
    bare = value.strip(" ")
    return bare[1:-1] if len(bare) >= 3 and bare[0] == "{" and bare[-1] == "}" else None


def is_checked_as_literal(value: str) -> bool:
    """True if the check of literals looks at `value`: it is stricter than `key_of` about blanks around the braces."""
    return not (len(value) >= 3 and value[0] == "{" and value[-1] == "}")
