"""What may follow at the end of a text of tests: the words that begin a line, then what missions complete."""

from __future__ import annotations

import re

from btlang.frontends.mission.completion.completer import Completion, completions
from btlang.testing.statements import OPENERS
from btlang.vocabulary.lexicon import Lexicon

_OPENED = re.compile(
    r"(?P<opener>\s*(?:then\s+|and\s+)*"
    r"(?:(?:within|for|after)\s+\S+\s+[a-z]+,?\s+(?!\s)|(?:with|when|before|always|never|finally),?\s+|(?=\S)))(?P<rest>.*)",
    re.IGNORECASE,
)
_BLOCK = re.compile(
    r"\n(?P<margin>[ \t]+)run:[ \t]*\n(?P<mission>(?:(?P=margin)[ \t]+\S.*\n|[ \t]*\n)*(?P=margin)[ \t]+.*)\Z"
)


def completions_in_tests(text: str, vocabulary: Lexicon) -> tuple[Completion, ...]:
    """All that may follow; `vocabulary` has the words of the tests (see test_file.WORDS) and of their world."""
    block = _BLOCK.search(text)
    if block is not None:
        return _shifted(completions(block["mission"], vocabulary), block.start("mission"))
    begin = text.rfind("\n") + 1
    line = text[begin:]
    word = line.strip()
    found: list[Completion] = []
    if begin and (not word or word.isalpha()):
        start = begin + len(line) - len(word)
        found = [
            Completion(opener, start, "connective", f"for example: {example}")
            for opener, example in OPENERS.items()
            if opener.startswith(word) and opener != word
        ]
    opened = _OPENED.fullmatch(line)
    if opened is None or not begin:
        return tuple(found)
    first = opened["opener"].split()[-1:]
    head, _, rest = opened["rest"].rpartition(",") if first in (["when"], ["before"]) else ("", "", opened["rest"])
    openers = ("",) if first == ["with"] or (first == ["when"] and head) else ("check ", "")
    for opener in openers:
        at = begin + len(line) - len(rest.lstrip()) - len(opener)
        found += _shifted(completions(opener + rest.lstrip(), vocabulary), at)
    return tuple({(one.text, one.start): one for one in found}.values())


def _shifted(found: tuple[Completion, ...], by: int) -> tuple[Completion, ...]:
    return tuple(one.replace(start=one.start + by) for one in found)
