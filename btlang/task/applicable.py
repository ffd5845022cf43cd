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
_ROBOT: Mapping[str, tuple[str, Sequence[str]]] = {
    "up": ("brings a robot up: btc robot up --robot museum.toml", _UP),
    "down": ("ends the process of the robot", ("json",)),
    "status": ("shows what the robot is doing, or why it can't work", ("json",)),
    "report": (
        'reports what was done, and why something wasn\'t: btc robot report --since "2 hours ago"',
        ("since", "json"),
    ),
    "stop": ("emergency stop: stops the robot at once", ("reason", "json")),
    "release": ("lets the robot move again after a stop", ("json",)),
    "pause": ("brings the robot to rest in the middle of a task", ("json",)),
    "resume": ("continues after a pause", ("json",)),
    "step": ("advances a paused robot by one tick", ("json",)),
    "say": ("says a text, whatever else the robot is doing: btc robot say we close in ten minutes", ("json",)),
    "visitor": ("lets a visitor come, in a simulated world", ("json",)),
    "unit": ("prints a systemd unit that brings the robot up", _UP),
    "check": ("checks a robot file: btc robot check museum.toml", ()),
    "show": ("shows the body of a robot: btc robot show museum.toml", ()),
    "urdf": ("prints the body of a robot as URDF: btc robot urdf museum.toml", ()),
    "import": ("converts a URDF to a robot file: btc robot import museum.urdf", ()),
    "backup": ("copies the store into a file: btc robot backup monday.db", ("store",)),
    "restore": ("fills an empty store from a backup: btc robot restore monday.db", ("store",)),
    "invite": ("lets a robot on another computer join a server here: btc robot invite lobby", ()),
    "revoke": ("revokes an invitation, and disconnects the robot: btc robot revoke lobby", ()),
    "invited": ("lists the invitations", ("json",)),
}
_TASK: Mapping[str, tuple[str, Sequence[str]]] = {
    "add": ('gives the robot a task: btc task add patrol.txt, btc task add -c "go to the lab"', (*_ADD, "at", "by")),
    "list": (
        "lists the tasks that aren't over, the next one first: btc task list --live",
        ("all", "live", "limit", "label", "json"),
    ),
    "show": ("shows everything about a task: btc task show 3", ("json",)),
    "cancel": ("ends a task, and halts its commands: btc task cancel 3", ("reason", "json")),
    "kill": ("ends a task at once, like an emergency stop: btc task kill 3", ("reason", "json")),
    "interrupt": ("halts a task, which can continue later: btc task interrupt 3 --reason lunch", ("reason", "json")),
    "resume": ("ends an interruption: btc task resume 3 --token 1f2e", ("token", "json")),
    "skip": ("skips a task that hasn't begun: btc task skip 3", ("reason", "json")),
    "move": ("gives a task another place in the queue: btc task move 3 --before 1", ("priority", "before", "json")),
    "again": ("adds a copy of an earlier task: btc task again 3", ("json",)),
    "schedule": (
        'adds a schedule: btc task schedule patrol.txt --every "every day at 9:00"',
        (*_ADD, "every", "zone", "overlap", "missed", "within"),
    ),
    "schedules": ("lists the schedules", ("json",)),
    "unschedule": ("removes a schedule, but not the tasks that it added: btc task unschedule 2", ("json",)),
    "put": ("saves a file in the library under a name: btc task put tour tour.txt", ("code", "kind", "json")),
    "delete": ("removes an item from the library: btc task delete tour", ("kind", "json")),
    "library": ("lists the library, or the revisions of one item: btc task library tour", ("kind", "json")),
    "trail": ("lists the latest commands, and who gave them: btc task trail --limit 10", ("limit", "json")),
    "answer": ("answers a question of the robot: btc task answer yes", ("json",)),
}
"""By the acts, what each does, and the options that mean something there; `--name` always does."""
ROBOT_ACTS, TASK_ACTS = ({act: about for act, (about, _) in acts.items()} for acts in (_ROBOT, _TASK))
"""What `btc robot` and `btc task` do."""
ROBOT_OPTIONS, TASK_OPTIONS = ({act: options for act, (_, options) in acts.items()} for acts in (_ROBOT, _TASK))
"""The options of each act by their destinations, apart from `--name`."""
COMPONENT_ACTS: Mapping[str, str] = {
    "list": "lists the components and devices with their states",
    "restart": "restarts a component: btc components restart camera",
    "load": "loads a component: btc components load camera",
    "unload": "unloads a component: btc components unload camera",
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
    _check(options, found, _ROBOT[options.act][1])
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
    _check(options, found, _TASK[act][1])
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
