"""What a comparison of a count is about: `count the cups. If there are more than 3 cups, wave`, not `3 people`."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import Called, Listed, Token
from btlang.text.source import Source, Span
from btlang.tree.sums import COMPARED, COUNTING
from btlang.vocabulary.value_type import OBJECT, PERSON

_KINDS, _SORT = "kinds", "counted"
COUNTED = {"CountPeople": PERSON, "CountObjects": OBJECT, "CountKind": OBJECT}
"""What commands count, by their ids."""


def with_counted_things(tokens: list[Token], source: Source) -> Iterator[Diagnostic]:
    """Leave out of a comparison what it says that was counted; report it where something else was (BT150)."""
    last: Called | Listed | None = None
    for token in tokens:
        said = token.value
        if not isinstance(said, Called | Listed):
            continue
        if said.entry.id in COUNTING:
            last = said
        elif said.entry.id == COMPARED and isinstance(said, Called):
            things = {name: text for name, text in said.arguments if name in (_KINDS, _SORT)}
            token.value = said.replace(arguments=tuple(each for each in said.arguments if each[0] not in things))
            if things and last is not None and not _counts(last, things):
                span = Span(source, token.start, token.end)
                reason = "what was counted last is something else"
                example = f"count the {span.text.split()[-1]}. If {span.text}, wave"
                yield diagnostic("BT150", span, words=span.text, reason=reason, example=example)


def _counts(said: Called | Listed, things: dict[str, str]) -> bool:
    """Whether a command counts things of a kind, or people."""
    first = said.arguments if isinstance(said, Called) else said.arguments[0]
    counted = {_SORT: COUNTED[said.entry.id], _KINDS: dict(first).get(_KINDS, "")}
    return all(counted[name] == text for name, text in things.items())
