"""Nodes that ask whether a blackboard entry was set anew: updated_decorator.cpp and updated_action.cpp of 4.10.

The first time they ask, an entry that has a value counts as new; setting the value that it has counts too. No halt
makes them forget what they have seen. One difference: halting a decorator halts its child; there the child is left
alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.build import Site, halt_nothing
from btlang.engine.gated import gated
from btlang.engine.ports import key_port
from btlang.engine.status import IDLE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled


def skip_unless_updated(site: Site, children: Sequence[Compiled]) -> Compiled:
    """Its child where the entry is new, else SKIPPED; a RUNNING child is ticked on without asking."""
    is_new = _news(site)
    return gated(children, lambda: IDLE if is_new() else SKIPPED)


def wait_value_update(site: Site, children: Sequence[Compiled]) -> Compiled:
    """RUNNING until the entry is new, then its child."""
    is_new = _news(site)
    return gated(children, lambda: IDLE if is_new() else RUNNING)


def was_entry_updated(site: Site, children: Sequence[Compiled]) -> Compiled:
    """SUCCESS where the entry is new, else FAILURE."""
    is_new = _news(site)
    refusal = f"nothing has been written to {{{key_port(site, 'entry')}}} since it last asked"
    return (lambda: SUCCESS if is_new() else site.fail(refusal)), halt_nothing


def _news(site: Site) -> Callable[[], bool]:
    scope, key = site.scope, key_port(site, "entry")
    seen = -1

    def is_new() -> bool:
        nonlocal seen
        before = seen
        if key in scope:
            seen = scope.writes(key)
        return seen != before

    return is_new
