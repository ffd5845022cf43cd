"""The life of a component: the states and transitions of ROS 2 managed nodes (design.ros2.org, "Managed nodes")."""

from __future__ import annotations

from btlang.support.record import Record

UNCONFIGURED, INACTIVE, ACTIVE, FINALIZED = STATES = "unconfigured", "inactive", "active", "finalized"


class Transition(Record):
    """From one of the states to another; `hook` is the method of the component that does it.

    Where the hook raises, the component's `error` hook is called, and the state is `fails`.
    """

    name: str
    begins: tuple[str, ...]
    ends: str
    hook: str
    fails: str = UNCONFIGURED


TRANSITIONS = {
    each.name: each
    for each in (
        Transition("configure", (UNCONFIGURED,), INACTIVE, "configure"),
        Transition("activate", (INACTIVE,), ACTIVE, "activate"),
        Transition("deactivate", (ACTIVE,), INACTIVE, "deactivate"),
        Transition("clean up", (INACTIVE,), UNCONFIGURED, "clean_up"),
        Transition("shut down", (UNCONFIGURED, INACTIVE, ACTIVE), FINALIZED, "shut_down", FINALIZED),
    )
}
"""By name."""
UPWARDS = ("configure", "activate")
"""From unconfigured to active."""
