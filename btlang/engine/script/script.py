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
from btlang.engine.script.parser import parse
from btlang.engine.script.tokens import ScriptError
from btlang.engine.script.values import ScriptFailed, as_text, truth

__all__ = ["ScriptError", "ScriptFailed", "as_text", "compile_script", "truth"]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def compile_script(code: str, enums: Mapping[str, float] | None = None) -> Callable[[Blackboard], Any]:
    """A function that runs the code on a blackboard and returns its value: a float, a text or what a leaf wrote.

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
