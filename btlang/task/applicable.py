"""Which options and words each act of `btc robot` and `btc task` takes: others are refused, not ignored in silence."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from math import inf

from btlang.task.messages import wrong

_UP = (
    "robot", "over", "simulate", "world", "keywords", "rules", "schedules", "store", "durable", "keep", "record",
    "no_recordings", "allow_keywords", "include_root", "speed", "serve", "host", "port", "join", "code", "answers",
)  # fmt: skip
_ADD = ("code", "priority", "label", "restart", "set", "keywords", "json")
_ROBOT: Mapping[str, Sequence[str]] = {
    "up": _UP, "down": ("json",), "status": ("json",), "report": ("since", "json"), "stop": ("reason", "json"),
    "release": ("json",), "pause": ("json",), "resume": ("json",), "step": ("json",), "say": ("json",),
    "visitor": ("json",),
    "unit": _UP, "check": (), "show": (), "urdf": (), "import": (),
    "backup": ("store",), "restore": ("store",), "invite": (), "revoke": (), "invited": ("json",),
}  # fmt: skip
_TASK: Mapping[str, Sequence[str]] = {
    "add": (*_ADD, "at", "by"), "list": ("all", "live", "limit", "label", "json"), "show": ("json",),
    "cancel": ("reason", "json"), "kill": ("reason", "json"), "interrupt": ("reason", "json"),
    "resume": ("token", "json"), "skip": ("reason", "json"), "move": ("priority", "before", "json"),
    "again": ("json",), "schedule": (*_ADD, "every", "zone", "overlap", "missed", "within"),
    "schedules": ("json",), "unschedule": ("json",), "put": ("code", "kind", "json"),
    "delete": ("kind", "json"), "library": ("kind", "json"), "trail": ("limit", "json"), "answer": ("json",),
}  # fmt: skip
"""By the acts, the options that mean something there; `--name` always does."""
ROBOT_ACTS, TASK_ACTS = tuple(_ROBOT), tuple(_TASK)
"""What `btc robot` and `btc task` do."""
COMPONENT_ACTS = ("list", "restart", "load", "unload")
"""What `btc components` does."""
FLEET_ACTS = ("invite", "revoke", "invited")
"""Those of `btc robot` that are about a server's robots elsewhere."""
_NO_WORDS = ("up", "down", "status", "report", "release", "pause", "resume", "step", "visitor", "unit", "invited")
_MOST_WORDS = {"list": 0, "schedules": 0, "trail": 0, "put": 2, "answer": inf}
"""Where it isn't one."""
_NOT_GIVEN = object()


def note_given(parser: argparse.ArgumentParser) -> None:
    """To be called when a parser has all options: `given` can then distinguish those that were given."""
    options = [action for action in parser._actions if action.option_strings and action.dest != "help"]
    flags = {action.dest: action.option_strings[-1] for action in options}
    for action in options:
        action.help = (action.help or "").replace("%(default)s", str(action.default))
    usual = {action.dest: action.default for action in options if not isinstance(action.default, list)}
    parser.set_defaults(**dict.fromkeys(usual, _NOT_GIVEN), usual=usual, flags=flags)


def check_robot_words(options: argparse.Namespace) -> None:
    """Raises MissionError (BT198) for what `btc robot` doesn't take, and gives the other options their defaults."""
    found = _given(options)
    if options.act == "stop":
        return  # whatever else is typed: it stops
    _check(options, found, _ROBOT[options.act])
    for each, other in (("host", "serve"), ("port", "serve"), ("code", "join")):
        if each in found and other not in found:
            raise wrong(options.act, f"{options.flags[each]} needs {options.flags[other]}")
    if options.act in _NO_WORDS:
        _check_count(options, 0)
    elif options.act != "say":  # which says all of them
        _check_count(options, 1)


def check_task_words(options: argparse.Namespace) -> None:
    """As `check_robot_words`, for `btc task`."""
    act, found = options.act, _given(options)
    _check(options, found, _TASK[act])
    most = _MOST_WORDS.get(act, 1)
    if "code" in found and len(options.item) == most:
        raise wrong(act, f"it takes -c TEXT or '{options.item[-1]}', but not both")
    _check_count(options, most - ("code" in found))
    for first, second in (("live", "json"), ("priority", "before")):
        if act in ("list", "move") and {first, second} <= found:
            raise wrong(act, f"it takes {options.flags[first]} or {options.flags[second]}, but not both")
    if act == "list" and len(options.label) > 1:
        raise wrong(act, "it takes one --label")
    if not all(options.label):
        raise wrong(act, "--label needs a text")


def _given(options: argparse.Namespace) -> set[str]:
    found = {each for each in options.flags if each not in options.usual and getattr(options, each)}
    for each, default in options.usual.items():
        if getattr(options, each) is _NOT_GIVEN:
            setattr(options, each, default)
        else:
            found.add(each)
    return found


def _check(options: argparse.Namespace, found: set[str], allowed: Sequence[str]) -> None:
    for each, flag in options.flags.items():
        if each in found and each not in allowed and each != "name":
            raise wrong(options.act, f"{flag} doesn't apply to it")


def _check_count(options: argparse.Namespace, most: float) -> None:
    if len(options.item) > most:
        raise wrong(options.act, f"'{options.item[int(most)]}' is more than it takes")
