"""Tokens between the stages of reading English.

Raw tokens (from `lexer`) have the kinds of connective roles and punctuation. The grouping stage turns them into
grouped tokens, which need no look-ahead any more:

    COMMAND CONDITION                      operands
    SEMI OR_ELSE WIDE_AND THEN AFTER OR AND    between commands, loosest first
    BLOCK_AND BLOCK_OR                     in place of SEMI between the lines of `in parallel:`, `the first that works:`
    BLOCK_CHILD                            the same between the children of a node that is said by its id
    COND_OR_ELSE COND_WIDE_AND COND_OR COND_AND NOT    between and before conditions
    OPEN CLOSE COND_OPEN COND_CLOSE        brackets; a block is a bracket too
    POSTFIX                                after one command: `twice`, `within 10 s`, ...
    FORM cond DO body [ELSE body] END      if, unless, while, until before a command
    AFTER_FORM cond [ELSE body] END        the same after one command, and `provided that`
    WIDE_FORM cond END                     the same after a comma at the end: takes the whole statement
    LOOP body [STOP cond] END              repeat, every, after 5 s, for each, and try: LOOP body [ELSE body] END;
                                           also a node that is said by its id with its children
    TEST cond END                          check, wait until
"""

from __future__ import annotations

from btlang.record import Record
from btlang.vocabulary.entry import Entry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Listed(Record):
    """A phrase with a list in one slot: arguments for each value. `joiner` is "and", "or" or ""."""

    entry: Entry
    arguments: tuple[tuple[tuple[str, str], ...], ...]
    joiner: str


class Assigned(Record):
    """`operation` is "set", "increase" or "decrease"; `text` is the port text of a value of the type `kind`."""

    key: str
    operation: str
    kind: str
    text: str


class Remembered(Record):
    """What a quantity measures, with the arguments of its slots, under a key."""

    key: str
    entry: Entry
    arguments: tuple[tuple[str, str], ...]


class Each(Record):
    """The values, all of the type `kind`, that a key goes through."""

    key: str
    kind: str
    values: tuple[str, ...]


class NodeCall(Record):
    """A node by its id, its ports and its name, as they are."""

    id: str
    ports: tuple[tuple[str, str], ...]
    name: str


class Token:
    """One token: `value` depends on its kind; `start` and `end` are characters of the source.

    Mutable, for the grouping stage learns later what a comma means and which count closes a `repeat`.
    """

    __slots__ = ("end", "kind", "start", "value")

    def __init__(self, kind: str, value: Any, start: int, end: int) -> None:
        self.kind = kind
        self.value = value
        self.start = start
        self.end = end

    def __repr__(self) -> str:
        return f"{self.kind}({self.value!r})" if self.value is not None else self.kind
