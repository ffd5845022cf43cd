"""The `ros` table of a keyword entry: how a phrase uses an interface of a ROS 2 robot. Described in docs/ros_words.md.

It is read and checked here as far as that needs no ROS 2: keys, forms, and the slots that texts name in braces.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from btlang.text.spelling import nearest
from btlang.vocabulary.ros_binding import Fields, RosBinding

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.vocabulary.ros_binding import Value

SLOT = re.compile(r"\{(\w+)(?::([^{}]+))?\}")
"""A slot in a text: `{distance}`, or `{distance:cm}` for its value in that unit."""

LIMITS = ("below", "above", "at_least", "at_most", "equal", "not_equal")
"""What the value of a condition may be compared with."""
REDUCTIONS = ("min", "max", "mean", "sum", "any", "all")
"""What makes one value of those of an array."""
WAYS = ("forward", "backward", "left", "right")
"""Where to a `drive` goes: two of them are driven, two are turned."""


_ANSWER = {"failed": "text", "succeeded": "text", "reason": "text", "wait": "positive"}
_LATEST = {
    "field": "text", "age": "positive", "latched": "flag", "scale": "number", "reduce": "reduction",
    "indexes": "range", "degrees": "range",
}  # fmt: skip
_LIMITS = dict.fromkeys(LIMITS, "value")
_DRIVE = {"speed": "amount", "odometry": "text", "tolerance": "number", "patience": "positive"}
KINDS: dict[str, dict[str, dict[str, str]]] = {
    "action": {"action": {"goal": "fields", **_ANSWER}},
    "phrase": {"action": {"wait": "positive"}},
    "service": {"action": {"request": "fields", **_ANSWER, "limit": "positive"}},
    "publish": {
        "action": {
            "message": "fields", "finally": "fields", "for": "amount", "rate": "positive", "wait": "positive",
            "latched": "flag",
        }
    },
    "topic": {"condition": {**_LATEST, **_LIMITS}, "quantity": _LATEST},
    "parameter": {
        "action": {"set": "value", "wait": "positive", "limit": "positive"},
        "condition": {"age": "positive", **_LIMITS},
        "quantity": {"age": "positive", "scale": "number"},
    },
    "drive": {"action": {**dict.fromkeys(WAYS, "amount"), **_DRIVE}},
    "joints": {
        "action": {
            "positions": "fields", "states": "text", "duration": "amount", "tolerance": "number",
            "patience": "positive",
        }
    },
}  # fmt: skip
"""The kinds of binding; for each sort of entry that may have it, its keys and their forms."""

_FORMS = {
    "text": "a text",
    "flag": "true or false",
    "number": "a number",
    "positive": "a number above 0",
    "amount": 'a number or a slot such as "{distance}"',
    "value": 'true, false, a number, a text or a slot such as "{distance}"',
    "range": "two numbers, such as [-20, 20]",
    "fields": 'a table of fields, such as { data = "{text}" }',
    "reduction": "one of " + ", ".join(REDUCTIONS),
}
_TYPED = {
    "action": "action", "service": "srv", "publish": "msg", "topic": "msg", "drive": "msg", "joints": "msg"
}  # fmt: skip
_UNTYPED = {"parameter": "the name of a parameter", "phrase": "a phrase or the id of a served action"}
_EXAMPLES = {
    "action": "nav2_msgs/action/NavigateToPose", "srv": "std_srvs/srv/Trigger", "msg": "std_msgs/msg/String"
}  # fmt: skip


def read_ros(table: object, sort: str) -> tuple[RosBinding | None, list[tuple[str, str]]]:
    """The binding of an entry of a sort, None where it has none; and what is wrong, each with a text near it."""
    if not isinstance(table, dict):
        return None, [
            ('it must be a table such as { topic = "sensor_msgs/msg/BatteryState", name = "/battery_state" }', "ros")
        ]
    kinds = [kind for kind in KINDS if kind in table]
    if len(kinds) != 1:
        near = [kind for key in table for kind in nearest(str(key), KINDS, 1)]
        said = f"both {kinds[0]} and {kinds[1]} are given" if kinds else "none is given"
        said += f"; similar: {near[0]}" if near and not kinds else ""
        return None, [(f"it needs one of the keys {', '.join(KINDS)}, and {said}", "ros")]
    [kind] = kinds
    keys = KINDS[kind].get(sort)
    if keys is None:
        return None, [
            (f"{kind} is for {' and '.join(_plural(other) for other in KINDS[kind])}, not for {_plural(sort)}", kind)
        ]
    wrong = [
        (f"'{key}' is not a key for {kind}; the keys are {', '.join(sorted({kind, 'name', *keys}))}", key)
        for key in table
        if key not in (kind, "name", *keys)
    ]
    interface, name = table[kind], table.get("name")
    middle = _TYPED.get(kind)
    if middle and not (isinstance(interface, str) and re.fullmatch(rf"\w+/{middle}/\w+", interface)):
        wrong.append((f'{kind} must be a type such as "{_EXAMPLES[middle]}"', str(interface)))
    elif not isinstance(interface, str) or not interface:
        wrong.append((f"{kind} must be {_UNTYPED[kind]}", kind))
    if not isinstance(name, str) or not re.fullmatch(r"[/~]?\w+(/\w+)*", name):
        wrong.append((f'name = "..." must be the name of {_named(kind)}, such as "/robot/arm"', str(name or kind)))
    options = []
    for key, form in keys.items():
        if key in table:
            value = _frozen(table[key])
            if value is None or not _has_form(value, form):
                wrong.append((f"{key} must be {_FORMS[form]}", key))
            else:
                options.append((key, value))
    if not wrong:
        wrong += [(reason, kind) for reason in _missing(kind, sort, dict(options))]
    return (None, wrong) if wrong else (RosBinding(kind, str(interface), str(name), tuple(options)), [])


def _missing(kind: str, sort: str, options: dict[str, Value]) -> Iterator[str]:
    """What keys that are right by themselves lack together."""
    if kind == "drive" and sum(way in options for way in WAYS) != 1:
        yield f"drive needs one of {', '.join(WAYS)}"
    if kind == "joints" and not options.get("positions"):
        yield "joints needs positions = { elbow = 1.2 }, in radians or metres"
    if kind == "parameter" and sort == "action" and "set" not in options:
        yield "parameter needs set = ..., its new value"
    if kind == "parameter" and sort == "condition" and not options.keys() & set(LIMITS):
        yield f"parameter needs one of {', '.join(LIMITS)}"
    if kind == "topic" and sort == "quantity" and "field" not in options:
        yield 'topic needs field = "...", the field to measure'
    if kind == "topic" and "field" not in options and options.keys() & {*LIMITS, "reduce", "scale"}:
        yield 'topic needs field = "...", the field to compare'
    if "indexes" in options and "degrees" in options:
        yield "indexes and degrees both select a part of an array: give only one"
    if kind == "publish" and "finally" in options and "for" not in options:
        yield 'finally needs for = "{duration}": it is sent after that time'


def _frozen(value: object, path: str = "") -> Value | None:
    """A value of TOML without lists and dictionaries; None where it cannot fill a message. Tables within tables become
    paths of fields.
    """
    if isinstance(value, str | bool | int | float):
        return value
    if isinstance(value, list):
        items = [_frozen(item) for item in value]
        return None if None in items else tuple(item for item in items if item is not None)
    if not isinstance(value, dict):
        return None
    given: list[tuple[str, Value]] = []
    for key, inner in value.items():
        frozen = _frozen(inner)
        if frozen is None:
            return None
        given += [(f"{key}.{p}", v) for p, v in frozen.given] if isinstance(frozen, Fields) else [(key, frozen)]
    return Fields(tuple(given))


def _has_form(value: Value, form: str) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if form == "flag":
        return isinstance(value, bool)
    if form == "number":
        return number
    if form == "positive":
        return number and value > 0  # type: ignore[operator]
    if form == "amount":
        return number or (isinstance(value, str) and SLOT.fullmatch(value) is not None)
    if form == "fields":
        return isinstance(value, Fields)
    if form == "range":
        return isinstance(value, tuple) and len(value) == 2 and all(_has_form(item, "number") for item in value)
    if form == "reduction":
        return value in REDUCTIONS
    return isinstance(value, str) if form == "text" else not isinstance(value, Fields | tuple)


def _plural(sort: str) -> str:
    return "quantities" if sort == "quantity" else f"{sort}s"


def _named(kind: str) -> str:
    names = {"service": "the service", "action": "the action", "phrase": "the action", "parameter": "the node"}
    return names.get(kind, "the topic")


def slots_of(value: Value) -> Iterator[str]:
    """The names of the slots that the texts of a value use."""
    values: list[Value] = [value]
    while values:
        value = values.pop()
        if isinstance(value, str):
            yield from (name for name, _ in SLOT.findall(value))
        elif isinstance(value, Fields):
            values += [inner for _, inner in value.given]
        elif isinstance(value, tuple):
            values += value


def unknown_slots(binding: RosBinding, slots: Iterable[str]) -> list[str]:
    """The slots that its texts name and no phrase has."""
    known, used = set(slots), slots_of(tuple(value for _, value in binding.options))
    return list(dict.fromkeys(name for name in used if name not in known))
