"""The script language of BehaviorTree.CPP 4.10: short code that computes with the blackboard.

    count := 3; message := 'battery at ' .. level .. '%'; level < 20 || count > 2 ? 'low' : 'fine'

Statements are separated by `;`, which may be left out, as there; the value is that of the last. From loose to tight:

    :=  =  +=  -=  *=  /=    `:=` makes the entry if there is none, the others need one; from right to left
    ? :                      from right to left
    ||    then &&            both sides are evaluated
    == != < <= > >=          `a < b < c` is `a < b` and `b < c`; numbers no further apart than 2**-23 are equal
    | ^   then &             whole numbers of 64 bits
    + - ..  then * /         `+` adds numbers and joins texts, `..` joins texts and numbers
    -x !x ~x

Values are numbers (`3`, `0.5`, `1e-3`, `0xFF`, `true` is 1, `false` is 0), which are doubles, texts in single quotes,
and what else leaves have written, which can only be passed on. A name is an enum or a key of the blackboard; `@name`
is a key of the outermost one. A text that is compared with a number, assigned to an entry that holds one, or asked by
`?` counts as the number that it stands for.

Where this differs from BehaviorTree.CPP:
- a number in a text is `3` or `0.5`; there it is `3` or `0.500000`, by the type of the entry;
- every number is a double; there an entry that was made with `3` is an integer, takes no fraction, and is no operand of
  `&&` and `||` but as 0 or 1. A whole number is written to the blackboard as an int all the same, so that leaves
  show it as `3`;
- a text counts as a number only as a whole; there `'3 m' == 3` holds;
- that only a name stands before `=` is checked when the script is compiled, and a whole number that does not fit
  64 bits is refused; there these fail when the script runs, or count as 0;
- what fails to run leaves no empty entry behind, and a script nests at most 200 levels deep.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.engine.blackboard import Blackboard
from btlang.engine.script import closures
from btlang.engine.script.tokens import ASSIGNMENTS, BOOLEANS, ScriptError, Tokens
from btlang.engine.script.values import COMPARISONS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.script.closures import Run
    from btlang.engine.script.values import Enums


MOST_LEVELS = 200
"""How deep a script may nest, in brackets and in operators: the closures call each other as deep."""

_ASSIGN, _CHOOSE, _COMPARE, _PREFIX = 1, 2, 5, 10
_LEVELS = {
    **dict.fromkeys(ASSIGNMENTS, _ASSIGN),
    "?": _CHOOSE,
    "||": 3,
    "&&": 4,
    **dict.fromkeys(COMPARISONS, _COMPARE),
    **dict.fromkeys("|^", 6),
    "&": 7,
    **dict.fromkeys(("+", "-", ".."), 8),
    **dict.fromkeys("*/", 9),
}  # a higher one binds tighter
_PREFIXES = ("-", "~", "!")


class _PendingOperator:
    """An operator that waits for its right operand, or a bracket or `?` that waits for its end."""

    __slots__ = ("level", "name", "position", "signs")

    def __init__(self, sign: str, level: int, position: int, name: str = "") -> None:
        self.signs = [sign]  # several for a chain of comparisons
        self.level = level  # 0 for what waits for its end: no operator takes it for its operand
        self.position = position
        self.name = name  # what an assignment assigns to


def parse(text: str, enums: Enums) -> list[Run]:
    """Parse the statements. Raises ScriptError if there is none, or if they can't be read."""
    statements = []
    tokens = Tokens(text)
    while tokens.kind != "end":
        statements.append(_StatementParser(tokens, enums).parse())
        while tokens.sign == ";":
            tokens.advance()
    if not statements:
        raise ScriptError("the script is empty", 0)
    return statements


class _StatementParser:
    """A statement that is being read: operands and their operators on two stacks."""

    def __init__(self, tokens: Tokens, enums: Enums) -> None:
        self.tokens = tokens
        self.enums = enums
        self.constants = {**enums, **BOOLEANS}
        self.operands: list[tuple[Run, int, str]] = []  # with their depth, and the name where one stands alone
        self.waiting: list[_PendingOperator] = []

    def parse(self) -> Run:
        wanted = True
        while True:
            if wanted:
                wanted = self._operand()
            elif self.tokens.sign in _LEVELS:
                self._operator()
                wanted = True
            elif self.tokens.sign in (")", ":"):
                wanted = self._close()
            else:
                break
            self.tokens.advance()
        self._reduce(_ASSIGN)
        if self.waiting:
            raise self._not_closed(self.waiting[-1])
        return self.operands[0][0]

    def _operand(self) -> bool:
        """Take a value, a prefix or an opening bracket; return whether a value is still wanted after it."""
        token = self.tokens
        if token.sign in _PREFIXES:
            self._wait(_PendingOperator(token.sign, _PREFIX, token.position))
            return True
        if token.sign == "(":
            self._wait(_PendingOperator("(", 0, token.position))
            return True
        if token.kind == "number":
            run = closures.constant(token.number())
        elif token.kind == "text":
            run = closures.constant(token.text[1:-1])
        elif token.kind != "name":
            raise ScriptError(f"a value is missing {token.described()}", token.position)
        elif token.text in self.constants:
            run = closures.constant(self.constants[token.text])
        else:
            run = closures.name(token.text)
        name = token.text if token.kind == "name" and token.text not in BOOLEANS else ""
        self.operands.append((run, 1, name))
        return False

    def _operator(self) -> None:
        sign, position = self.tokens.sign, self.tokens.position
        level = _LEVELS[sign]
        # assignments and choices group to the right, and comparisons make chains
        self._reduce(level + 1 if level in (_ASSIGN, _CHOOSE, _COMPARE) else level)
        if level == _COMPARE and self.waiting and self.waiting[-1].level == _COMPARE:
            self.waiting[-1].signs.append(sign)
        elif level == _ASSIGN:
            _, _, name = self.operands.pop()
            if not name:
                raise ScriptError(f"only a name can come before {sign}", position)
            self._wait(_PendingOperator(sign, level, position, name))
        else:
            self._wait(_PendingOperator(sign, 0 if sign == "?" else level, position))

    def _close(self) -> bool:
        """Take `)` or `:`; return whether a value is wanted after it."""
        sign, position = self.tokens.sign, self.tokens.position
        self._reduce(_ASSIGN)
        opened = self.waiting.pop() if self.waiting else None
        begin = "(" if sign == ")" else "?"
        if opened is None:
            raise ScriptError(f"{sign} has no {begin} before it", position)
        if opened.signs != [begin]:
            raise self._not_closed(opened)
        if sign == ":":
            self.waiting.append(_PendingOperator(":", _CHOOSE, opened.position))
        return sign == ":"

    def _not_closed(self, opened: _PendingOperator) -> ScriptError:
        if opened.signs == ["("]:
            return ScriptError("this ( is not closed", opened.position)
        return ScriptError("this ? has no :", opened.position)

    def _wait(self, operator: _PendingOperator) -> None:
        if len(self.waiting) == MOST_LEVELS:
            raise ScriptError(f"this is nested more than {MOST_LEVELS} levels deep", operator.position)
        self.waiting.append(operator)

    def _reduce(self, level: int) -> None:
        """Give the operators on top that bind at least so tight their operands."""
        while self.waiting and self.waiting[-1].level >= level:
            operator = self.waiting.pop()
            count = _operands_of(operator)
            parts = self.operands[-count:]
            depth = 1 + max(depth for _, depth, _ in parts)
            if depth > MOST_LEVELS:
                raise ScriptError(f"this is nested more than {MOST_LEVELS} levels deep", operator.position)
            self.operands[-count:] = [(self._make(operator, [run for run, _, _ in parts]), depth, "")]

    def _make(self, operator: _PendingOperator, parts: list[Run]) -> Run:
        sign = operator.signs[0]
        if operator.level == _PREFIX:
            return closures.prefix(sign, *parts)
        if operator.level == _COMPARE:
            return closures.comparison(operator.signs, parts, self.enums)
        if operator.level == _CHOOSE:
            return closures.choice(self.enums, *parts)
        if operator.level == _ASSIGN:
            return closures.assignment(self.enums, sign, operator.name, *parts)
        return closures.infix(sign, *parts)


def _operands_of(operator: _PendingOperator) -> int:
    if operator.level == _COMPARE:
        return len(operator.signs) + 1
    return {_PREFIX: 1, _ASSIGN: 1, _CHOOSE: 3}.get(operator.level, 2)


def compile_script(code: str, enums: Mapping[str, float] | None = None) -> Callable[[Blackboard], Any]:
    """Make a function that runs the code on a blackboard and returns its value: a float, a text or what a leaf wrote.

    Raises ScriptError where the code cannot be read. The function raises ScriptFailed where it cannot go on; what it
    has assigned until then stays.
    """
    *before, last = parse(code, {name: float(value) for name, value in (enums or {}).items()})
    if not before:
        return last

    def run(board: Blackboard) -> Any:
        for statement in before:
            statement(board)
        return last(board)

    return run
