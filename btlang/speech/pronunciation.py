"""How words are pronounced, in phones of the CMU dictionary: other accents of a word, and guesses by its letters."""

from __future__ import annotations

import re

_LETTERS = {
    "tch": "CH", "sch": "SH", "igh": "AY", "tion": "SH AH N", "ch": "CH", "sh": "SH", "th": "TH", "ph": "F", "ck": "K",
    "ng": "NG", "qu": "K W", "wh": "W", "kn": "N", "wr": "R", "ee": "IY", "ea": "IY", "ie": "IY", "oo": "UW",
    "ou": "AW", "ow": "OW", "ai": "EY", "ay": "EY", "ei": "AY", "ey": "IY", "oa": "OW", "oi": "OY", "oy": "OY",
    "au": "AO", "aw": "AO", "eu": "OY", "er": "ER", "ir": "ER", "ur": "ER", "ar": "AA R", "or": "AO R", "ce": "S EH",
    "ci": "S IH", "cy": "S IY", "a": "AE", "b": "B", "c": "K", "d": "D", "e": "EH", "f": "F", "g": "G", "h": "HH",
    "i": "IH", "j": "JH", "k": "K", "l": "L", "m": "M", "n": "N", "o": "OW", "p": "P", "q": "K", "r": "R", "s": "S",
    "t": "T", "u": "AH", "v": "V", "w": "W", "x": "K S", "y": "IY", "z": "Z",
}  # fmt: skip
_PIECE = re.compile("|".join(sorted(_LETTERS, key=len, reverse=True)))
_AT_THE_END = {"a": "AH", "o": "OW", "i": "IY", "u": "UW"}
_VOWEL = "aeiou"
_BRITISH = ((re.compile(r"\bOW\b"), "AH UW"), (re.compile(r"\bER$"), "AH"))


def guessed(word: str) -> str:
    """The phones of a word that no dictionary has, by its letters; "" for one without any."""
    letters = re.sub(r"(.)\1+", lambda match: match[0] if match[1] in "eo" else match[1], word.replace("'", ""))
    end = ""
    if len(letters) > 2 and letters[-1] == "e" and letters[-2] not in _VOWEL:
        letters = letters[:-1]
    elif len(letters) > 1 and letters[-1] in _AT_THE_END and letters[-2] not in _VOWEL:
        letters, end = letters[:-1], _AT_THE_END[letters[-1]]
    phones = " ".join(_LETTERS[piece] for piece in _PIECE.findall(letters))
    if letters.startswith("y") and phones.startswith("IY "):
        phones = f"Y {phones[3:]}"
    return f"{phones} {end}".strip()


def accents(phones: str) -> list[str]:
    """How else the phones of American English are said: "no" and "never" in the south of England."""
    other = phones
    for pattern, said in _BRITISH:
        other = pattern.sub(said, other)
    return [] if other == phones else [other]
