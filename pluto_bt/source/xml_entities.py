"""Entities of XML as tinyxml2 reads them: the five named ones and numbers; there are no others, since document types are refused."""

from __future__ import annotations

import re

ENTITY = re.compile(r"&(?:#([0-9]{1,7})|#x([0-9a-fA-F]{1,6})|(amp|lt|gt|quot|apos));")
_NAMED = {"amp": "&", "lt": "<", "gt": ">", "quot": '"', "apos": "'"}


def decoded(raw: str) -> str:
    """The text with its entities decoded; anything else that begins with `&` stays as it is."""
    return ENTITY.sub(character, raw)


def character(entity: re.Match[str]) -> str:
    """The character that an entity stands for, or the entity itself if there is no such character."""
    decimal, hexadecimal, name = entity.groups()
    if name:
        return _NAMED[name]
    code = int(decimal) if decimal else int(hexadecimal, 16)
    is_character = 0 < code <= 0x10FFFF and not 0xD800 <= code <= 0xDFFF
    return chr(code) if is_character else entity.group()
