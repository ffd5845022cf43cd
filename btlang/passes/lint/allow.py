"""Comments that silence warnings: `# allow: two readings`, with commas between several names.

Behind a statement such a comment counts for that statement, with the block that it opens; on a line of its own it
counts for the whole mission. In XML, `<!-- allow: never runs -->` counts for the whole file.
"""

from __future__ import annotations

import re
from bisect import bisect
from collections.abc import Iterable, Iterator

from btlang.diagnostics.codes import NAMES
from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.text.source import Source, Span
from btlang.text.spelling import nearest
from btlang.text.words import Words, split
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.trie import longest

_ALLOW = r"(?i)#\s*allow\s*:(?P<names>[^\n]*)"
_IN_XML = re.compile(r"(?i)<!--\s*allow\s*:([^<>]*)-->")
_NAME = r"[^,\s](?:[^,]*[^,\s])?"


def apply_allow(compilation: Compilation) -> Iterator[Diagnostic]:
    """Leave out the warnings that a comment silences, and report names in such comments that no warning has (BT056)."""
    source, vocabulary = compilation.mission.span.source, compilation.vocabulary
    if "#" not in source.text or not re.search(_ALLOW, source.text):
        return
    words = split(source, vocabulary.orthography)
    for _, span, code in _allowed_names(words):
        if not code:
            from btlang.frontends.mission.explanations.spelling_rule import (
                is_respelling,  # most comments name what there is
            )

            near = nearest(span.text.lower(), NAMES)
            fix = (span, near[0]) if near and is_respelling(span.text, near[0], vocabulary) else None
            yield diagnostic("BT056", span, fix=fix, name=span.text, near=", ".join(near or sorted(NAMES)))
    compilation.warnings = _filter_allowed(compilation.warnings, words, vocabulary)


def not_silenced(problems: Iterable[Diagnostic], source: Source, vocabulary: Lexicon) -> list[Diagnostic]:
    """Return the problems that no comment of their mission silences."""
    return _filter_allowed(problems, split(source, vocabulary.orthography), vocabulary)


def _filter_allowed(problems: Iterable[Diagnostic], words: Words, vocabulary: Lexicon) -> list[Diagnostic]:
    silent: dict[str, list[tuple[int, int]]] = {}
    for comment, _, code in _allowed_names(words):
        silent.setdefault(code, []).append(_scope(comment, words, vocabulary))
    return [
        problem
        for problem in problems
        if problem.span.source is not words.source
        or not any(start <= problem.span.start < end for start, end in silent.get(problem.code, ()))
    ]


def _allowed_names(words: Words) -> Iterator[tuple[Span, Span, str]]:
    """Yield each name in such a comment: the comment, the place of the name, and its code, "" for none."""
    for comment in words.comments:
        match = re.fullmatch(_ALLOW, comment.text.rstrip())
        for name in re.finditer(_NAME, match["names"]) if match else ():
            start = comment.start + match.start("names") + name.start() if match else 0
            code = NAMES.get(" ".join(name[0].lower().split()), "")
            yield comment, Span(comment.source, start, start + len(name[0])), code


def apply_allow_in_xml(compilation: Compilation) -> Iterable[Diagnostic]:
    """Silence the warnings about a tree from XML, without BT056."""
    if not compilation.is_text and any(warning.span.source.text[:1] == "<" for warning in compilation.warnings):
        compilation.warnings = not_allowed(compilation.warnings)
    return ()


def not_allowed(problems: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return the problems that no comment of their XML file silences; errors stay."""
    silent: dict[str, set[str]] = {}
    left = []
    for problem in problems:
        text = problem.span.source.text
        if text not in silent:
            names = ",".join(_IN_XML.findall(text)).lower().split(",")
            silent[text] = {NAMES.get(" ".join(name.split()), "") for name in names}
        if problem.is_error or problem.code not in silent[text]:
            left.append(problem)
    return left


def _scope(comment: Span, words: Words, vocabulary: Lexicon) -> tuple[int, int]:
    """Return the characters that a comment counts for."""
    source = words.source
    lines = words.lines
    own = bisect(lines, comment.start, key=lambda line: words.starts[line.first]) - 1
    if own < 0 or "\n" in source.text[words.starts[lines[own].first] : comment.start]:
        return 0, len(source.text) + 1
    last = own
    while last + 1 < len(lines):
        following = lines[last + 1]
        if following.indent < lines[own].indent:
            break
        if following.indent == lines[own].indent and not _continues(following.first, words, vocabulary):
            break
        last += 1
    return words.starts[lines[own].first], words.ends[lines[last].last]


def _continues(at: int, words: Words, vocabulary: Lexicon) -> bool:
    match = longest(vocabulary.trie, words, at, vocabulary.context)
    return match is not None and match.meaning.role == "otherwise"
