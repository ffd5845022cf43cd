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
ROBOT_ACTS: Mapping[str, str] = {
    "up": "brings a robot up: btc robot up --robot museum.toml",
    "down": "ends its process",
    "status": "says what it does, or what keeps it from doing more",
    "report": 'says what was done, and why something was not: btc robot report --since "2 hours ago"',
    "stop": "stops it at once, an emergency stop",
    "release": "lets it move again after a stop",
    "pause": "brings it to rest in the middle of a task",
    "resume": "lets it go on after a pause",
    "step": "goes on by one tick of a pause",
    "say": "says a text, whatever else it does: btc robot say we close in ten minutes",
    "visitor": "a visitor comes, where the world is simulated",
    "unit": "prints a unit for systemd",
    "check": "checks a robot file: btc robot check museum.toml",
    "show": "shows the body of a robot: btc robot show museum.toml",
    "urdf": "prints its body as URDF",
    "import": "makes a robot file of a URDF",
    "backup": "copies its store into a file: btc robot backup monday.db",
    "restore": "fills an empty store from such a file",
    "invite": "lets a robot elsewhere join a server here: btc robot invite lobby",
    "revoke": "ends what an invitation allowed",
    "invited": "lists the invitations",
}
"""What `btc robot` does."""
TASK_ACTS: Mapping[str, str] = {
    "add": 'gives the robot a task: btc task add patrol.txt, btc task add -c "go to the lab"',
    "list": "lists the tasks that aren't over, the next one first",
    "show": "shows everything about a task: btc task show 3",
    "cancel": "ends a task as a mission is halted: btc task cancel 3",
    "kill": "ends a task at once",
    "interrupt": "halts a task, so that it can go on later: btc task interrupt 3 --reason lunch",
    "resume": "ends an interruption: btc task resume 3 --token 1f2e",
    "skip": "leaves out a task that hasn't begun",
    "move": "gives a task another place in the queue: btc task move 3 --before 1",
    "again": "adds a task like an earlier one: btc task again 3",
    "schedule": 'adds a schedule: btc task schedule patrol.txt --every "every day at 9:00"',
    "schedules": "lists the schedules",
    "unschedule": "removes a schedule, but not the tasks that it made: btc task unschedule 2",
    "put": "keeps a mission under a name: btc task put tour tour.txt",
    "delete": "removes a mission that is kept",
    "library": "lists what is kept, or the revisions of one: btc task library tour",
    "trail": "lists the latest commands, and who gave them",
    "answer": "answers what the robot asks: btc task answer yes",
}
"""What `btc task` does."""
COMPONENT_ACTS: Mapping[str, str] = {
    "list": "lists them with their states",
    "restart": "begins one anew: btc components restart camera",
    "load": "begins one that isn't loaded",
    "unload": "ends one",
}
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
