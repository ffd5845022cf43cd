"""Which defined names stand for conditions."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence

from btlang.frontends.mission.token import (
    CORRELATIVES,
    QUANTIFIERS,
    Called,
    Header,
    Listed,
    Token,
    asks_once,
    begins_condition,
)
from btlang.vocabulary.entry import Entry


def condition_names(tokens: list[Token], included: Iterable[str]) -> set[str]:
    """A name is a condition where its body holds only conditions, condition names, and words that join or deny them.

    `included` are those of included missions.
    """
    needs = {name: _names_in_condition(body) for name, body in _bodies(tokens)}
    needs |= {name: set() for name in included if name not in needs}
    users: dict[str, list[str]] = {}
    for name, needed in needs.items():
        for other in needed or ():
            users.setdefault(other, []).append(name)
    conditions: set[str] = set()
    ready = [name for name, needed in needs.items() if needed is not None and not needed]
    while ready:
        name = ready.pop()
        conditions.add(name)
        for user in users.get(name, ()):
            waiting = needs[user]
            if waiting is not None:
                waiting.discard(name)
                if not waiting:
                    ready.append(user)
    return conditions


def settle(tokens: Sequence[Token], conditions: Container[str]) -> None:
    """Gives the tokens that are a command or a condition, or join or count, the kind that they have here."""
    for at in range(len(tokens) - 1, -1, -1):
        token = tokens[at]
        if token.kind == "name":
            token.kind = "condition" if called(token).id in conditions else "command"
        elif token.kind == "followed_by":
            token.kind = "then"
        elif token.kind == "once":
            is_unknown = tokens[at + 1 : at + 2] != [] and tokens[at + 1].kind == "unknown"
            if not (begins_condition(tokens, at + 1) or (is_unknown and asks_once(tokens, at))):
                token.value = "1"
            token.kind = "count" if token.value else "as_soon_as"


def called(token: Token) -> Entry:
    """The entry of a token that is a phrase or a name."""
    assert isinstance(token.value, Called | Listed)
    return token.value.entry


def _bodies(tokens: list[Token]) -> Iterator[tuple[str, list[Token]]]:
    """Each definition's name and the tokens of its body, as far as the line or block goes."""
    for at, token in enumerate(tokens):
        if token.kind != "define":
            continue
        depth, body = 0, []
        for i in range(at + 1, len(tokens)):
            inner = tokens[i]
            depth += (inner.kind == "indent") - (inner.kind == "dedent")
            if depth < 0 or (depth == 0 and inner.kind in ("newline", "semi", "define")):
                break
            body.append(inner)
        assert isinstance(token.value, Header)
        yield token.value.name, body


_IN_CONDITIONS = frozenset(
    ("condition", "not", "and", "or", "nor", "comma", "open", "close", *QUANTIFIERS, *CORRELATIVES)
)


def _names_in_condition(body: list[Token]) -> set[str] | None:
    """The names that a body needs to be conditions in order to be one itself; None where it cannot be one."""
    if not body or not all(token.kind in _IN_CONDITIONS or token.kind == "name" for token in body):
        return None
    return {called(token).id for token in body if token.kind == "name"}
