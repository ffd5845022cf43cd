"""The children of a node that ticks them in turn, as cheaply as Python can: function leaves are called directly.

A wrapper around each function would take as long as the function itself. So such a node calls the functions as they
are, and hands to `settle` what is neither True nor False: another answer, or an exception.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.leaves import as_function, status_of, unanswered
from btlang.engine.status import FAILURE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.build import Compiled, Halt, Site

    Ticks: TypeAlias = tuple[Callable[[], Any], ...]
    Row: TypeAlias = tuple[Ticks, tuple[Halt, ...], tuple[Site | None, ...]]


def row(children: Sequence[Compiled]) -> Row:
    """What to call for a tick of each child, the halts, and the sites of function leaves, None for another child.

    Whoever calls the ticks catches all but KeyboardInterrupt, and settles what he caught, all answers that are no
    status, and each FAILURE because of which he fails, so that the failure is that of the leaf.
    """
    functions = [as_function(tick) for tick, _ in children]
    ticks = [tick if leaf is None else leaf.call for (tick, _), leaf in zip(children, functions, strict=True)]
    sites = [None if leaf is None else leaf.site for leaf in functions]
    return tuple(ticks), tuple([halt for _, halt in children]), tuple(sites)


def settle(site: Site | None, answer: object) -> int:
    """The status that an answer, or an exception that was raised instead, stands for; that of a node is its own."""
    if site is None:
        if isinstance(answer, BaseException):
            raise answer
        assert isinstance(answer, int)
        return answer
    if answer is FAILURE:
        return site.refuse()
    return unanswered(site, answer) if isinstance(answer, BaseException) else status_of(site, answer)
