"""The children of a node that ticks them in turn, as cheaply as Python can: function leaves are called directly.

A wrapper around each function would take as long as the function itself. So such a node calls the functions as they
are, and hands to `settle` what is neither True nor False: another answer, or an exception.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.leaves import FunctionLeaf, as_function, failed, status_of
from btlang.engine.status import FAILURE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.build import Compiled, Halt

    Ticks: TypeAlias = tuple[Callable[[], Any], ...]
    Row: TypeAlias = tuple[Ticks, tuple[Halt, ...], tuple[FunctionLeaf | None, ...]]


def row(children: Sequence[Compiled]) -> Row:
    """What to call for a tick of each child, the halts, and the function leaves, None for a child that is none.

    Whoever calls the ticks catches Exception, and settles what he caught, all answers that are no status, and each
    FAILURE because of which he fails, so that the failure is that of the leaf.
    """
    leaves = tuple([as_function(tick) for tick, _ in children])
    ticks = tuple([tick if leaf is None else leaf.call for (tick, _), leaf in zip(children, leaves, strict=True)])
    return ticks, tuple([halt for _, halt in children]), leaves


def settle(leaf: FunctionLeaf | None, answer: object) -> int:
    """The status that an answer, or an exception that was raised instead, stands for; that of a node is its own."""
    if leaf is None:
        if isinstance(answer, Exception):
            raise answer
        assert isinstance(answer, int)
        return answer
    if answer is FAILURE:
        leaf.site.shared.fault = leaf.site
        return FAILURE
    return failed(leaf.site, answer) if isinstance(answer, Exception) else status_of(leaf.site, answer)
