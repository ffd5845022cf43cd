"""The verb `robot`: brings a robot up with its task layer, and sends commands to one that is up."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import sys
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial

from btlang.cli.parser import check_act, check_count
from btlang.cli.robot_log import RobotLog
from btlang.cli.robots import note_silent_voice
from btlang.cli.task import ask, print_answer
from btlang.components.words import words_of
from btlang.diagnostics.diagnostic import MissionError
from btlang.robots.ears import read_answers
from btlang.robots.registry import connector, runs_in_real_time
from btlang.run.controls import emergency_signal
from btlang.task import messages
from btlang.task.commands.client import (
    USUAL_NAME,
    RobotClient,
    data_folder,
    emergency_stop,
    find_listening,
    robots_known,
)
from btlang.task.commands.companion import companions, require_companions
from btlang.task.commands.down import COMMAND
from btlang.task.commands.socket_server import SocketServer
from btlang.task.commands.store_handlers import latest_text
from btlang.task.execution.manager import DAY
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import KEPT, TaskLayer, keep_ticks_in_time, make_robot_layer
from btlang.task.schedule.calendar import format_moment
from btlang.task.store.backup import restore_backup
from btlang.task.store.location import latest_store, usual_store, without_password
from btlang.task.store.records import ACTIVE, WAITING, LibraryKind
from btlang.task.store.task_store import TaskStore, open_store
from btlang.text.formatting import joined, one_line
from btlang.text.output import pass_on, show

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    from typing import Any

    from btlang.robots.registry import Connector
    from btlang.text.source import Source

_UNIT = """{note}[Unit]
Description=The robot '{name}' (btlang)
After=network.target

[Service]
ExecStart={command}
WorkingDirectory={folder}
Restart=on-failure
KillSignal=SIGTERM
TimeoutStopSec=30

[Install]
WantedBy=default.target
"""

_SECRET = """# The password of the store is in this file: let nobody else read it (chmod 600).
# Or leave it out of the URL, and write it into ~/.pgpass, where PostgreSQL looks for it.
"""
_LIBRARY = "library:"
_BODY = "body"
"""The setting of the store that names the body that was up at last."""
_FLEET_ACTS = ("invite", "revoke", "invited")  # about a server's robots elsewhere
_CONTROL = re.compile(r"[\0-\x1f\x7f]")
_PLAIN = re.compile(r"[\w@%+=:,./-]+", re.ASCII)


def run_act(options: argparse.Namespace) -> int:
    """Do what the act says; return the exit code. Raises MissionError."""
    act = options.act
    given = check_act(options)
    for each, other in (("host", "serve"), ("port", "serve"), ("code", "join")) if act != "stop" else ():
        if each in given and other not in given:
            raise messages.wrong(act, f"{options.flags[each]} needs {options.flags[other]}")
    check_count(options)
    if act in _FLEET_ACTS:
        from btlang.cli.users import change_invitations

        return change_invitations(options)
    if act == "up":
        return _up(options)
    if act == "list":
        return _list_robots(options.json)
    if act in ("check", "show", "urdf", "import"):
        from btlang.cli.robot_file import read_robot_file

        return read_robot_file(act, options.item[0])
    if act == "unit":
        pass_on(_unit(options))
        return 0
    if act in ("backup", "restore"):
        return _copy(options)
    if act == "stop":
        for line in emergency_stop(options.name, options.reason):
            show(line)
        with (
            suppress(MissionError),
            RobotClient(options.name) as client,
        ):  # the robot stands already; this is for the trail
            client.send(messages.EmergencyStop(options.reason))
        return 0
    if act == "say" and not options.item:
        raise messages.wrong(act, "it needs a text")
    commands: dict[str, Callable[[], messages.Command]] = {
        "down": messages.Down, "status": messages.Status, "report": partial(messages.Report, options.since),
        "release": messages.Release, "pause": messages.Pause, "resume": messages.Resume,
        "step": messages.Step, "say": partial(messages.Say, " ".join(options.item)), "visitor": messages.InviteVisitor,
    }  # fmt: skip
    if act == "status" and not options.json:
        return _show_status(options.name)
    return ask(options.name, commands[act](), options.json)


def _show_status(name: str) -> int:
    """Print what the robot does, and what it has to do by its rules and schedules; return the exit code."""
    with RobotClient(name) as client:
        answer = client.send(messages.Status())
    code, data = print_answer(answer, as_json=False), answer.data
    if answer.ok:
        if data["next_schedule"] is not None:
            show(f"The next schedule is due at {format_moment(data['next_schedule'], time.time())}.")
        if data["battery"] is not None:
            show(f"The battery is at {data['battery']:.0f}%.")
        for hand, thing in data["holds"].items():
            show(f"Its {hand} hand holds: {thing}")
        for rule in data["rules"]:
            show(f"House rule: {rule}")
    return code


def layer_options(options: argparse.Namespace, name: str) -> dict[str, Any]:
    """Return what the options TASK_LAYER settle for the TaskLayer of a robot."""
    folder = data_folder(name)
    recordings = None if options.no_recordings else options.record or os.path.join(folder, "recordings")
    return {
        "folder": folder, "store": options.store or usual_store(folder), "rules": options.rules,
        "schedules": options.schedules,
        "durable": options.durable, "recordings": recordings,
        "keeps": KEPT if options.keep is None else options.keep * DAY,
        "answers": options.answers and read_answers(options.answers),
    }  # fmt: skip


def _up(options: argparse.Namespace) -> int:
    """Bring a robot up until `btc robot down`, Ctrl-C or SIGTERM."""
    name, ended = options.name or USUAL_NAME, threading.Event()
    layer: TaskLayer
    log: RobotLog | None = None

    def handle(data: dict[str, Any], person: str) -> messages.Answer:
        answer = layer.handle(data, person)
        if log is not None:
            log.look(person)
        return answer

    server = SocketServer(
        name,
        lambda data, person: handle(data, person),
        lambda person: layer.stop(person),
        lambda *wanted: layer.feed.watch(*wanted),
    )
    try:  # the name is ours before the store and the robot are touched
        require_companions(options)
        kept = layer_options(options, name)
        robot, world = _from_library(options, kept)
        note_silent_voice(robot)
        if options.speed != "real" and runs_in_real_time(robot.body, robot.over, options.simulate):
            options.refuse(f"the robot runs in real time over {robot.over}, so it takes no --speed")
        words = [] if options.robot.startswith(_LIBRARY) else words_of(robot.body)
        reader = MissionReader(
            [*words, *options.keywords],
            world,
            include_root=options.include_root,
            allowed_keywords=options.allow_keywords,
        )
        trouble, down = (lambda text: show(one_line(text), sys.stderr)), ended.set
        layer = make_robot_layer(robot, reader, **kept, speed=options.speed, trouble=trouble, down=down)
    except BaseException:
        server.close()
        raise
    with emergency_signal(partial(layer.stop, "the keyboard"), layer.disable):
        try:
            try:
                for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                    if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:  # ignored under nohup
                        signal.signal(number, lambda *_: ended.set())
                has_secret = options.code is not None or without_password(options.store) != options.store
                command = "" if has_secret else shlex.join(["btc", *_words_of(options)])
                left = left_over(layer.store, robot.body.name, command)
                layer.start()
                server.start()
                keep_ticks_in_time()
                for line in _greeting(name):
                    show(line)
                for line in left:
                    show(line)
                if layer.emergency.is_latched:
                    show(
                        f"It is stopped: {layer.emergency.reason}. To let it move: btc robot release", stream=sys.stderr
                    )
                log = RobotLog(layer, show)
                with companions(options, name, show) as code:
                    while not code and not ended.wait(1.0):
                        pass
            finally:
                server.close()
        finally:
            layer.halt()
            if log is not None:  # it reads the store, which closes with the layer
                log.close()
            ended_well = layer.close()
    show(f"The robot '{name}' is down.")
    return code or (0 if ended_well else 1)


def _greeting(name: str) -> list[str]:
    """Say that a robot is up and how to give it work, also where others are up."""
    others = [each for each in find_listening() if each != name]
    which = f" --name {name}" if others else ""
    lines = [f"The robot '{name}' is up. Give it work with: btc task add{which}"]
    return [*lines, f"Up as well: {joined(others)}. Each command needs --name now."] if others else lines


def _list_robots(as_json: bool) -> int:
    """List the robots of this computer that are up, and those that were."""
    up = find_listening()
    states = {name: "up" if name in up else "down" for name in sorted({*up, *robots_known()})}
    if as_json:
        show(json.dumps(states, ensure_ascii=False, indent=2))
    else:
        width = max(map(len, states), default=0)
        show("\n".join(f"{name:{width}}  {state}" for name, state in states.items()) or "No robot was up so far.")
    return 0


def left_over(store: TaskStore, body: str, command: str = "") -> list[str]:
    """Say which tasks are left from before, and whether another robot file or another command brought it up then; the
    store keeps these.
    """
    count, before, up = store.count_tasks(WAITING | ACTIVE), store.setting(_BODY), store.setting(COMMAND)
    store.set_setting(_BODY, body)
    store.set_setting(COMMAND, command)
    if not count:
        return []
    are = "1 task is" if count == 1 else f"{count} tasks are"
    other = before not in ("", body)
    whose = f" They were for another body, '{one_line(before)}'; this one is '{one_line(body)}'." if other else ""
    whose = whose.replace("They were", "It was") if count == 1 else whose
    lines = [f"{are} left from before.{whose} To see {'it' if count == 1 else 'them'}: btc task list"]
    return lines if up in ("", command) else [*lines, f"Before, the robot was brought up with: {one_line(up)}"]


def _from_library(options: argparse.Namespace, kept: Mapping[str, Any]) -> tuple[Connector, str | Source | None]:
    """Read the robot and the world that options name, which may be in the robot's own library."""
    robot, world = options.robot, options.world
    over, named = options.over or ("devices" if options.simulate else None), {}
    if options.simulate:
        named["simulate"] = options.simulate
    if any(each is not None and each.startswith(_LIBRARY) for each in (robot, world)):
        os.makedirs(kept["folder"], mode=0o700, exist_ok=True)
        with open_store(kept["store"]) as store:
            robot = (
                latest_text(store, robot.removeprefix(_LIBRARY), LibraryKind.ROBOT)
                if robot.startswith(_LIBRARY)
                else robot
            )
            if world is not None and world.startswith(_LIBRARY):
                world = latest_text(store, world.removeprefix(_LIBRARY), LibraryKind.WORLD)
    chosen = connector(robot, over, **named)
    return chosen, world or chosen.body.world or None


def _unit(options: argparse.Namespace) -> str:
    """Write a unit of systemd that brings the robot up with these options."""
    words = [sys.executable, "-m", "btlang", *_words_of(options)]
    folder = os.getcwd()
    for word in (*words, folder):
        if _CONTROL.search(word):  # behind the end of a line would be another setting
            raise messages.wrong("unit", f"'{one_line(word)}' can't stand in a unit")
    return _UNIT.format(
        note=_SECRET if without_password(options.store) != options.store else "",
        name=options.name or USUAL_NAME,
        command=" ".join(map(_quote, words)),
        folder=folder.replace("%", "%%"),
    )


def _words_of(options: argparse.Namespace) -> list[str]:
    """Return the words of the command that brings the robot up with these options."""
    words = ["robot", "up"]
    for option in (
        "name",
        "robot",
        "over",
        "world",
        "rules",
        "schedules",
        "store",
        "record",
        "include_root",
        "join",
        "code",
        "answers",
    ):
        value = getattr(options, option)
        if value and value != "simulated":
            words += [f"--{option.replace('_', '-')}", os.path.abspath(value) if os.path.exists(value) else value]
    for option, names in (("--keywords", options.keywords), ("--allow-keywords", options.allow_keywords)):
        for each in names:
            words += [option, os.path.abspath(each) if os.path.exists(each) else each]
    for each in options.simulate:
        words += ["--simulate", each]
    words += [] if options.speed == "real" else ["--speed", str(options.speed)]
    words += [] if options.keep is None else ["--keep", f"{options.keep:g}"]
    words += ["--serve", "--host", options.host, "--port", str(options.port)] if options.serve else []
    return words + ["--durable"] * options.durable + ["--no-recordings"] * options.no_recordings


def _quote(word: str) -> str:
    """Quote a word of a command line for systemd."""
    plain = word.replace("\\", "\\\\").replace('"', '\\"').replace("%", "%%").replace("$", "$$")
    return plain if _PLAIN.fullmatch(word) else f'"{plain}"'


def _copy(options: argparse.Namespace) -> int:
    """Back up the store, or restore one."""
    if len(options.item) != 1:
        raise messages.wrong(options.act, "it needs a file")
    [path] = options.item
    folder = data_folder(options.name or USUAL_NAME)
    os.makedirs(folder, mode=0o700, exist_ok=True)
    if options.act == "restore":
        restore_backup(path, options.store or usual_store(folder))
        show(f"Restored {path}.")
    else:
        with open_store(options.store or latest_store(folder)) as store:
            store.backup(path)
        show(f"Wrote {path}.")
    return 0
