"""The table `idle` of robot files."""

from __future__ import annotations

from btlang.robots.body import Breathing, Idle

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.body import Body
    from btlang.text.toml_table import Table

LOOK_AT = "look at"
"""The posture in which the robot looks at somebody."""
_EVERY = (1.0, 60.0)  # seconds
_LEAST = 0.001


def read_idle(top: Table, body: Body) -> Idle:
    """What a robot does when it is idle. Raises Problem where its joints can't do that."""
    if not top.has("idle"):
        return Idle()
    if not body.is_smooth:
        raise top.problem("idle", 'only joints with an "acceleration" and a "jerk" can move when the robot is idle')
    table = top.table("idle")
    breathing = _breathing(table.table("breathing"), body) if table.has("breathing") else None
    looks = table.flag("look_at_speaker")
    if looks and body.bearing_joint(LOOK_AT) is None:
        says = f'"look_at_speaker" needs the posture "{LOOK_AT}"; write "{LOOK_AT}" = {{ "head turn" = "bearing" }}'
        raise table.problem("look_at_speaker", says)
    return table.finish(Idle(breathing, looks))


def _breathing(table: Table, body: Body) -> Breathing:
    name = table.choice("joint", tuple(joint.name for joint in body.joints))
    joint = body.joint(name)
    assert joint is not None
    by = table.number("by", low=_LEAST, high=max(_LEAST, (joint.high - joint.low) / 2))
    every = table.number("every", low=_EVERY[0], high=_EVERY[1])
    if every < (needs := 2 * joint.unhurried(2 * by)):
        raise table.problem("every", f'the {name} can\'t go so fast; "every" must be at least {needs:.2g}')
    return table.finish(Breathing(name, by, every))
