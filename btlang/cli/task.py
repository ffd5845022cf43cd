"""The verbs `task` and `components`: they make commands from options, for a robot that is up."""

from __future__ import annotations

import json
import os
import shutil
import sys
import time
from collections.abc import Callable
from contextlib import suppress

from btlang.cli.parser import check_act, check_count, quote_mission
from btlang.cli.verbs import VERBS
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.task import messages
from btlang.task.commands.checks import refusal_error
from btlang.task.commands.client import RobotClient, find_listening
from btlang.task.messages import Answer, Command, wrong
from btlang.task.store.records import TaskState
from btlang.text.formatting import one_line
from btlang.text.output import pass_on, show

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    from typing import Any

_LONGEST = 100  # figures of a number
_AGAIN = 0.5  # seconds between two looks of the live list


def run_act(options: argparse.Namespace) -> int:
    """Do what the act says; return the exit code: 1 if the robot refuses. Raises MissionError."""
    _check_words(options)
    if options.act == "why":
        return explain_task(options.name, _number(options), options.json)
    command = _command(options)
    if isinstance(command, messages.Submit | messages.AddSchedule) and not command.text:
        return _add_named_or_text(options, command)
    if options.live:
        with RobotClient(options.name) as client:
            return _live(client, command)
    return ask(options.name, command, options.json)


def _add_named_or_text(options: argparse.Namespace, command: messages.Submit | messages.AddSchedule) -> int:
    """Add the mission of the library that has this name, or else the mission that its words are."""
    with RobotClient(options.name) as client:
        is_named = client.send(messages.Library(command.name)).ok
        answer = client.send(command if is_named else command.replace(text=command.name, name=""))
        if not answer.ok and not is_named:
            if " " not in command.name:
                answer = client.send(command)  # which says that there's none of this name
            elif answer.code != "BT194":  # of its time, which is no mistake of the mission
                name = one_line(command.name)
                _note(f"There's no mission '{name}' in the library. As a mission it has mistakes:")
        return print_answer(answer, options.json)


def ask(name: str, command: Command, as_json: bool) -> int:
    """Print the answer of a robot, or of the store of one that is down; return the exit code. Raises MissionError."""
    from btlang.task.commands.down import open_reader

    with open_reader(name, command, _note) as client:
        return print_answer(client.send(command), as_json)


def explain_task(name: str, number: int, as_json: bool = False) -> int:
    """Print what became of a task, and what happened in its recorded run; return the exit code. Raises MissionError."""
    answer = _show(name, number)
    code = print_answer(answer, as_json)
    recording = answer.data.get("task", {}).get("recording", "")
    if answer.ok and not as_json and os.path.isfile(recording):
        from btlang.recording.story import explain_recording

        show("\n" + explain_recording(recording))
    return code


def recording_of(name: str, number: int) -> str:
    """Return the recording of a task. Raises MissionError, also if there's none (BT088) or no such task (BT187)."""
    from btlang.recording.reader import no_recording

    answer = _show(name, number)
    if not answer.ok:
        raise refusal_error(number, "isn't known")
    path: str = answer.data["task"]["recording"]
    if not os.path.isfile(path):
        state = answer.data["task"]["state"]
        raise no_recording(
            f"task {number}, which is {state}",
            "Tasks are recorded as they run, if 'btc robot up' allows it.",
        )
    return path


def _show(name: str, number: int) -> Answer:
    from btlang.task.commands.down import open_reader

    command = messages.Show(number)
    with open_reader(name, command, _note) as client:
        return client.send(command)


def _note(text: str) -> None:
    show(text, sys.stderr)


def change_components(options: argparse.Namespace) -> int:
    """List the components of the robot, or change one; return the exit code. Raises MissionError."""
    if (options.act == "list") == bool(options.item):
        raise wrong(options.act, "it takes no name" if options.item else "it needs the name of a component")
    command = messages.Components() if options.act == "list" else messages.ChangeComponent(options.item, options.act)
    with RobotClient(options.name) as client:
        return print_answer(client.send(command), options.json)


def _check_words(options: argparse.Namespace) -> None:
    """Raise MissionError (BT198) for what the act doesn't take."""
    act, given = options.act, check_act(options)
    if "code" in given and len(options.item) == VERBS["task"].acts[act].words:
        raise wrong(act, f"it takes -c TEXT or '{options.item[-1]}', but not both")
    if act == "schedule" and (parts := _rule_in(" ".join(options.item))):
        what, rule = parts
        command = f"btc task schedule {quote_mission(what)} --every {quote_mission(rule)}"
        raise wrong(act, f"say when with --every: {command}")
    if act in ("add", "schedule") and len(options.item) > 1:
        raise wrong(act, f"put the mission in quotes: btc task {act} {quote_mission(' '.join(options.item))}")
    check_count(options, "code" in given)
    for first, second in (("live", "json"), ("priority", "before")):
        if act in ("list", "move") and {first, second} <= given:
            raise wrong(act, f"it takes {options.flags[first]} or {options.flags[second]}, but not both")
    if act == "list" and len(options.label) > 1:
        raise wrong(act, "it takes one --label")
    if not all(options.label):
        raise wrong(act, "--label needs a text")


def _rule_in(text: str) -> tuple[str, str] | None:
    """Return what stands before or behind the rule of a schedule, and the rule: `round every day at 9`."""
    from btlang.task.schedule.recurrence import read_rule

    words = text.split()
    for at in range(1, len(words)):
        for what, rule in ((words[:at], words[at:]), (words[at:], words[:at])):
            with suppress(MissionError):
                read_rule(" ".join(rule))
                return " ".join(what), " ".join(rule)
    return None


def print_answer(answer: Answer, as_json: bool) -> int:
    """Print an answer; return the exit code."""
    if as_json:
        show(json.dumps(answer.as_json(), ensure_ascii=False, indent=2))
    elif answer.ok:
        pass_on(answer.text + "\n")
    else:
        show(answer.text, sys.stderr)
    return 0 if answer.ok else 1


def _live(client: RobotClient, command: Command) -> int:
    """Show the list until Ctrl-C, or until the robot is down. Where it isn't a terminal, changed lists are printed.

    Return the exit code. Raises MissionError (BT199) if the robot is up but doesn't answer.
    """
    from btlang.run.live.screen import LiveScreen

    screen, before = LiveScreen(sys.stdout, shutil.get_terminal_size), ""
    is_terminal = sys.stdout.isatty()
    try:
        if is_terminal:
            screen.begin()
        while True:
            answers = client.send(messages.Status()), client.send(command)
            if not all(answer.ok for answer in answers) and client.name not in find_listening():
                break  # it's going down, and its store is closed
            text = "\n\n".join(answer.text for answer in answers)
            if is_terminal:
                screen.draw([], [((one_line(line), ""),) for line in text.splitlines()])
            elif text != before:
                pass_on(text + "\n\n")
            before = text
            time.sleep(_AGAIN)
    except KeyboardInterrupt:
        return 0
    except MissionError:
        if client.name in find_listening():
            raise
    finally:
        if is_terminal:
            screen.leave()
            screen.end()
    show(f"The robot '{client.name}' is down.")
    return 0


def _command(options: argparse.Namespace) -> Command:
    """Make the command. Raises MissionError for words that make none (BT198)."""
    act, reason = options.act, options.reason
    if act in ("add", "schedule", "put"):
        return _with_mission(options)
    if act == "list":
        return _list(options)
    if act == "schedules":
        return messages.Schedules()
    if act == "library":
        return messages.Library(_word(options, "") if options.item else "", options.kind)
    if act == "trail":
        return messages.Trail() if options.limit is None else messages.Trail(options.limit)
    if act == "answer":
        return messages.AnswerQuestion(" ".join(options.item))
    if act == "delete":
        return messages.Delete(_word(options, f"the name of a {options.kind}"), options.kind)
    number = _number(options)
    if act == "move" and options.priority is None and not options.before:
        raise wrong(act, "it needs --before TASK or --priority N")
    if act == "move":
        return messages.Reorder(number, options.priority, options.before)
    if act == "resume":
        return messages.Resume(number, options.token)
    ends: dict[str, Callable[[int, str], Command]] = {
        "cancel": messages.Cancel, "kill": messages.Kill, "interrupt": messages.Interrupt, "skip": messages.Skip,
    }  # fmt: skip
    if act in ends:
        return ends[act](number, reason)
    return {"show": messages.Show, "again": messages.Again, "unschedule": messages.RemoveSchedule}[act](number)


def _list(options: argparse.Namespace) -> Command:
    wanted: dict[str, Any] = {"states": tuple(TaskState) if options.all else ()}
    if options.limit is not None or (options.all and not options.live):  # a live list is asked for again and again
        wanted["limit"] = options.limit
    return messages.List(**wanted, label=options.label[0] if options.label else "")


def _with_mission(options: argparse.Namespace) -> Command:
    text, name = options.code or "", ""
    if options.act == "put":
        name = options.item[0] if options.item else ""
        if not text:
            text = read_source(_word(options, "a name and a file", 1)).text
        return messages.Put(name, text, kind=options.kind)
    if not text:
        name = _word(options, "a mission in quotes, a file, or a name of the library")
        if os.path.exists(name) or name.endswith(".txt"):
            text, name = read_source(name).text, os.path.basename(name)
    given: dict[str, Any] = {
        "text": text, "name": name, "values": dict(_value(options.act, each) for each in options.set),
        "keywords": tuple(map(_keywords, options.keywords)), "priority": options.priority or 0,
        "labels": tuple(options.label), "restart": options.restart,
    }  # fmt: skip
    if options.act == "add":
        return messages.Submit(**given, at=options.at, by=options.by)
    if not options.every:
        raise wrong(options.act, 'it needs --every RULE, such as --every "every day at 9:00"')
    return messages.AddSchedule(
        options.every, **given, zone=options.zone, overlap=options.overlap, missed=options.missed, within=options.within
    )


def _value(act: str, text: str) -> tuple[str, str | float]:
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        raise wrong(act, f"--set needs NAME=VALUE, not '{text}'")
    try:
        return name.strip(), float(value) if "." in value else int(value)
    except ValueError:
        return name.strip(), value


def _keywords(name: str) -> str:
    """Return a keyword file by a path that the robot's process finds, too; the name of a pack stays."""
    return os.path.abspath(name) if os.path.exists(name) else name


def _number(options: argparse.Namespace) -> int:
    kind = "schedule" if options.act == "unschedule" else "task"
    return number_of(options.act, _word(options, f"the number of a {kind}"), kind)


def number_of(act: str, word: str, kind: str = "task") -> int:
    """Return the number that a word is. Raises MissionError (BT198) if it's none."""
    if not word.isdecimal() or len(word) > _LONGEST:
        raise wrong(act, f"'{word}' isn't the number of a {kind}")
    return int(word)


def _word(options: argparse.Namespace, wanted: str, at: int = 0) -> str:
    if len(options.item) <= at:
        raise wrong(options.act, f"it needs {wanted}")
    return str(options.item[at])
