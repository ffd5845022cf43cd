"""What is open at a place in a sentence: brackets, blocks, forms and conditions."""

from __future__ import annotations

from btlang.frontends.mission.token import Constraint, Token


class StackEntry:
    """One open thing. `kind` is "top", "block", "bracket", "head", "body", "choice", "condition",
    "condition bracket" or "condition list".

    The owners are the nearest open forms of the same bracket that a count, a count behind a comma (`pace_owner`), an
    `until` (or `while`, `for`) or an `otherwise` would belong to; `after` says what follows the end of a condition, of
    a head how its verbs are written.
    The next connective decides what the `commas` mean; `last` is the latest connective. `statement` of a group is "",
    "open" or "ended": its newest statement begins in the output at the index `begins`, the newest one that has ended
    at `latest`; `separator` is the token between them. The latest operand begins at `operand`. `joints` are the words
    "and" of the chain that is not over, which begins at `chain`. `is_group`: it holds statements; `is_condition`:
    operands in it are conditions. `commands` is where those of a group begin that no rule follows; `mixed`: rules stand
    among them. Its `constraints` hold over its newest statement. A list `begins` at a raw token and has so many `items`
    so far.
    """

    __slots__ = (
        "after",
        "begins",
        "chain",
        "commands",
        "commas",
        "constraints",
        "count_owner",
        "else_owner",
        "is_condition",
        "is_group",
        "items",
        "joints",
        "kind",
        "last",
        "latest",
        "mixed",
        "opener",
        "operand",
        "pace_owner",
        "separator",
        "statement",
        "stop_owner",
    )  # fmt: skip

    def __init__(
        self, kind: str, opener: Token | None = None, outer: StackEntry | None = None, after: str = ""
    ) -> None:
        self.kind = kind
        self.is_group = kind in ("top", "block", "bracket")
        self.is_condition = kind in ("condition", "condition bracket", "condition list")
        self.opener = opener
        self.after = after
        self.count_owner: StackEntry | None = outer.count_owner if outer else None
        self.pace_owner: StackEntry | None = outer.pace_owner if outer else None
        self.stop_owner: StackEntry | None = outer.stop_owner if outer else None
        self.else_owner: StackEntry | None = outer.else_owner if outer else None
        self.commas: list[Token] = []
        self.last: Token | None = None
        self.joints: list[Token] = []
        self.constraints: list[Constraint] = []
        self.statement = ""
        self.begins = self.chain = self.operand = self.items = 0
        self.latest: int | None = None
        self.commands: int | None = None
        self.mixed = False
        self.separator = "SEMI"

    def connective(self, token: Token) -> None:
        """Notes a connective: the commas before it take its meaning if it is `and` or `or`, else they mean `then`.

        A comma right before `and` or `or` (`a, b, and c`) is an Oxford comma where a comma stands before that too:
        it widens nothing.
        """
        condition = self.is_condition
        if token.kind == "COMMA":
            self.commas.append(token)
            self.last = token
            return
        follows_comma = self.last is not None and self.last.kind == "COMMA"
        if follows_comma and token.kind in ("WIDE_AND", "WIDE_MEANWHILE", "WIDE_OR"):
            token.kind = token.kind[5:]
        meaning = token.kind if token.kind in ("AND", "MEANWHILE", "OR") else ""
        self.settle(meaning)
        if token.kind == "WIDE_OR":
            token.kind = "OR_ELSE"
        if condition:
            token.kind = "COND_" + token.kind
        self.last = token

    def begin_chain(self) -> None:
        """A connective comes: unless it goes on with a chain, one begins with the operand before it."""
        if not self.joints and not self.commas:
            self.chain = self.operand

    def stop(self, token: Token) -> None:
        """A stop before a word that goes on: no comma before it looks any further."""
        self.settle()
        self.last = token

    def close_chain(self) -> None:
        """The chain of operands ends here: commas that no connective has decided mean `then` (or `and`)."""
        if self.commas:
            self.settle()
        self.last = None
        self.joints.clear()

    def settle(self, meaning: str = "") -> None:
        """The commas before this place look no further: they have a meaning, or else mean `then` (or `and`)."""
        if not self.commas:
            return
        kind = ("COND_" + (meaning or "AND")) if self.is_condition else (meaning or "THEN")
        for comma in self.commas:
            comma.kind = kind
        self.commas.clear()
