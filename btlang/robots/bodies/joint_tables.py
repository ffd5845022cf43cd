"""The joints, capsules, postures and idle motion of robot files, and whether the links of a body fit together."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from math import hypot

from btlang.robots.bodies.body import Breathing, Capsule, Idle, Joint, Vector
from btlang.robots.bodies.gesture import BEARINGS, Step
from btlang.text.toml_table import Problem, Table, is_coordinate
from btlang.vocabulary.capabilities import CAPABILITIES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.bodies.body import Body


BASE = "base"
"""The name in files for the link that wheels carry; in a body its name is ""."""
_LEAST = 0.001
_FRAME = ("link", "parent", "at", "axis")
LOOK_AT = "look at"
"""The posture in which the robot looks at somebody."""
_EVERY = (1.0, 60.0)  # seconds


def joint(table: Table) -> Joint:
    """Read a joint. Raises Problem."""
    name, part = table.text("name"), table.text("part")
    if part in CAPABILITIES:
        raise table.problem("part", f'"{part}" has another meaning; call the part "{name}", or similar')
    low = table.number("low")
    high = table.number("high", low=low)
    speed = table.number("speed", low=_LEAST)
    rest = table.number("rest", 0.0, low=low, high=high)
    slides = table.flag("slides")
    rates = table.has("acceleration"), table.has("jerk")
    if any(rates) and not all(rates):
        wanted, given = ("acceleration", "jerk") if rates[1] else ("jerk", "acceleration")
        raise table.problem(given, f'a joint with "{given}" needs "{wanted}" too')
    acceleration, jerk = (table.number(key, low=_LEAST) if all(rates) else 0.0 for key in ("acceleration", "jerk"))
    made = Joint(name, part, low, high, speed, rest, slides, acceleration, jerk)
    if not any(map(table.has, _FRAME)):
        return table.finish(made)
    link, parent = table.text("link"), table.text("parent") if table.has("parent") else BASE
    if link == BASE:
        raise table.problem("link", f'"{BASE}" is the link that no joint moves; choose another name')
    axis = _vector(table, "axis")
    length = hypot(*axis)
    if length < _LEAST:
        raise table.problem("axis", '"axis" must point somewhere; write axis = [0, 0, 1]')
    x, y, z = axis
    at, axis = _vector(table, "at"), (x / length, y / length, z / length)
    moves: Joint = made.replace(link=link, parent="" if parent == BASE else parent, at=at, axis=axis)
    return table.finish(moves)


def capsule(table: Table) -> Capsule:
    """Read a capsule. Raises Problem."""
    link = table.text("link")
    start, end, radius = _vector(table, "start"), _vector(table, "end"), table.number("radius", low=_LEAST)
    return table.finish(Capsule("" if link == BASE else link, start, end, radius))


def forbidden_pairs(top: Table) -> tuple[tuple[str, str], ...]:
    """Read the pairs of links that may not touch. Raises Problem."""
    pairs: list[tuple[str, str]] = []
    for index, item in enumerate(top.items("forbidden")):
        if not (isinstance(item, list) and len(item) == 2 and all(isinstance(name, str) for name in item)):
            raise Problem(
                '"forbidden" must be a list of pairs of links; write forbidden = [["left hand", "head"]]',
                "forbidden", index,
            )  # fmt: skip
        first, second = ("" if name == BASE else name for name in item)
        pairs.append((first, second))
    return tuple(pairs)


def link_problems(
    joints: Sequence[Joint], capsules: Sequence[Capsule], forbidden: Sequence[tuple[str, str]]
) -> Iterator[Problem]:
    """Return what doesn't fit together between joints and capsules."""
    parents: dict[str, str] = {"": ""}
    for index, each in enumerate(joints):
        if each.link in parents and each.link:
            yield Problem(f'two joints move the link "{each.link}"', "joints", index, "link")
        if each.link:
            parents[each.link] = each.parent
    known = ", ".join(f'"{link or BASE}"' for link in parents)
    for index, each in enumerate(joints):
        if each.parent not in parents:
            yield Problem(f'there is no link "{each.parent}"; the links are {known}', "joints", index, "parent")
        elif each.link and _in_circle(each.link, parents):
            yield Problem(
                f'the link "{each.link}" carries itself: its parents form a circle', "joints", index, "parent"
            )
        if bool(each.acceleration) != bool(joints[0].acceleration):
            yield Problem('either all joints have an "acceleration" or none has', "joints", index, "name")
    shaped = {each.link for each in capsules}
    for index, shape in enumerate(capsules):
        if shape.link not in parents:
            yield Problem(f'there is no link "{shape.link}"; the links are {known}', "capsules", index, "link")
    for index, pair in enumerate(forbidden):
        for link in pair:
            if link not in shaped:
                yield Problem(f'no capsule has the link "{link or BASE}"', "forbidden", index)
        if pair[0] == pair[1]:
            yield Problem("a link can't touch itself; write two links", "forbidden", index)


def postures(top: Table, joints: Sequence[Joint]) -> dict[str, tuple[Step, ...]]:
    """Read the steps of postures by name. Raises Problem."""
    found: dict[str, tuple[Step, ...]] = {}
    if not top.has("postures"):
        return found
    table = top.table("postures")
    known = {joint.name: joint for joint in joints}
    for name in table.keys():  # noqa: SIM118
        steps = table.tables(name) if table.is_list(name) else [table.table(name)]
        found[name] = tuple(step(each, known) for each in steps)
    return found


def step(table: Table, known: Mapping[str, Joint], others: Collection[str] = ()) -> Step:
    """Read the positions of some joints; `others` are keys of the table that aren't joints. Raises Problem."""
    found: dict[str, float | str] = {}
    for name in table.keys():  # noqa: SIM118
        if name in others:
            continue
        if name not in known:
            listed = ", ".join(known) or "none"
            raise table.problem(name, f'the robot has no joint "{name}"; its joints are {listed}')
        if table.is_text(name):
            found[name] = table.choice(name, BEARINGS)
        else:
            found[name] = table.number(name, low=known[name].low, high=known[name].high)
    return found


def _vector(table: Table, key: str) -> Vector:
    found = table.items(key)
    if len(found) != 3 or not all(map(is_coordinate, found)):
        raise table.problem(key, f'"{key}" must be metres ahead, left and up; write {key} = [0, 0, 1]')
    return float(found[0]), float(found[1]), float(found[2])


def _in_circle(link: str, parents: Mapping[str, str]) -> bool:
    at = link
    for _ in parents:
        at = parents.get(at, "")
        if not at:
            return False
    return True


def read_idle(top: Table, body: Body) -> Idle:
    """Read what a robot does when it is idle. Raises Problem if its joints can't do that."""
    if not top.has("idle"):
        return Idle()
    if not body.is_smooth:
        raise top.problem("idle", 'only joints with an "acceleration" and a "jerk" can move when the robot is idle')
    table = top.table("idle")
    breathing = _read_breathing(table.table("breathing"), body) if table.has("breathing") else None
    looks = table.flag("look_at_speaker")
    if looks and body.bearing_joint(LOOK_AT) is None:
        says = f'"look_at_speaker" needs the posture "{LOOK_AT}"; write "{LOOK_AT}" = {{ "head turn" = "bearing" }}'
        raise table.problem("look_at_speaker", says)
    return table.finish(Idle(breathing, looks))


def _read_breathing(table: Table, body: Body) -> Breathing:
    name = table.choice("joint", tuple(joint.name for joint in body.joints))
    joint = body.joint(name)
    assert joint is not None
    by = table.number("by", low=_LEAST, high=max(_LEAST, (joint.high - joint.low) / 2))
    every = table.number("every", low=_EVERY[0], high=_EVERY[1])
    if every < (needs := 2 * joint.rest_to_rest_seconds(2 * by)):
        raise table.problem("every", f'the {name} can\'t go so fast; "every" must be at least {needs:.2g}')
    return table.finish(Breathing(name, by, every))
