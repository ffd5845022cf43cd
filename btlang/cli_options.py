"""The options of each verb of the `btc` command."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from itertools import takewhile

from btlang.arguments import between, duration, speed
from btlang.cli_reading import (
    add_check_options,
    add_compile_options,
    add_diff_options,
    add_explain_options,
    add_format_options,
    add_grammar_options,
    add_listing_options,
    add_mission_options,
    add_reading_options,
    add_tree_options,
    add_words_options,
)
from btlang.frontends.mission.reader import DEFAULT_PARSER
from btlang.option_parser import OptionParser
from btlang.robots.platforms import add_robot_words
from btlang.run.limits import RATES
from btlang.text.spelling import respellings
from btlang.vocabulary.shipped import ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The options of the command line. Only those of its verb are made: making all takes a tenth of `btc check`.

    Without a verb, `btc` is the prompt, `btc FILE` and `btc "MISSION"` run a mission. A usage error is a line and a
    hint on standard error, and the exit code 2.
    """
    verb, *words = _with_verb(sys.argv[1:] if arguments is None else list(arguments))
    parser = _verb_parser(verb)
    for word in takewhile(lambda word: word != "--", words):
        if word.startswith("--") and " " not in word:
            parser.check_option(word.partition("=")[0])
    read = (
        parser.parse_known_intermixed_args if verb in ("robot", "task", "world", "gesture") else parser.parse_known_args
    )
    options, unknown = read(words)
    if unknown:
        parser.refuse(f"unexpected argument '{unknown[0]}'")
    return options


def show_help(verb: str | None) -> None:
    """Prints the help of a verb, or that of `btc`. Ends with a usage error where there's no such verb."""
    if verb is None:
        _main_parser().print_help()
    elif verb in _OPTIONS:
        _verb_parser(verb).print_help()
    else:
        near = _near_verbs(verb)
        _main_parser().refuse(f"there's no verb '{verb}'", f"Did you mean: btc help {near[0]}" if near else "")


def verb_parsers() -> dict[str, tuple[str, argparse.ArgumentParser]]:
    """What each verb does, and the parser of its arguments."""
    return {verb: (about, _verb_parser(verb)) for verb, (about, _) in _OPTIONS.items()}


def _main_parser() -> OptionParser:
    usage = 'btc [VERB] [OPTION ...]\n       btc FILE|"MISSION" [OPTION ...]   as with the verb run'
    about = "Compiles and runs robot missions in plain English. 'btc help VERB' lists the options of a verb."
    parser = OptionParser("btc", usage=usage, description=about, add_help=False)
    for title, verbs in GROUPS.items():
        group = parser.add_argument_group(title)
        for verb in verbs:
            group.add_argument(verb, help=_OPTIONS[verb][0])
    return parser


def _verb_parser(verb: str) -> OptionParser:
    parser = OptionParser(f"btc {verb}")
    parser.set_defaults(**_DEFAULTS, verb=verb)
    _OPTIONS[verb][1](parser)
    if verb in _READING:
        add_robot_words(parser)
    return parser


def _with_verb(words: list[str]) -> list[str]:
    """The words with the verb that was left out. Ends with a usage error where it is rather a mistyped one."""
    if not words:
        return ["repl"]
    first = _ALIASES.get(words[0], words[0])
    if first in _OPTIONS:
        return [first, *words[1:]]
    if first in ("-", "-c") or os.path.exists(first):
        return ["run", *words]
    near = _near_verbs(first)
    is_alone = len(words) == 1 or words[1].startswith("-")
    mission = " ".join(words)
    if first.startswith("-"):
        _main_parser().refuse(f"unexpected option '{first}'", f"A verb comes first: btc VERB {shlex.join(words)}")
    if is_alone and (looks_like_path(first) or not near or reads_as_mission(first)):
        return ["run", *([] if looks_like_path(first) else ["-c"]), *words]
    hint = f"Did you mean: {shlex.join(('btc', near[0], *words[1:]))}" if near else ""
    if not is_alone and reads_as_mission(mission):
        hint = f"Put a mission in quotes: btc {quoted(mission)}"
    return _main_parser().refuse(f"there's no verb or file '{first}'", hint)


def _near_verbs(word: str) -> list[str]:
    return [verb for verb in respellings(word, _OPTIONS) if verb in _OPTIONS]


def looks_like_path(text: str) -> bool:
    """Whether a text is meant as the path of a file, there or not."""
    return os.path.splitext(text)[1][1:].isalpha() or (os.sep in text and len(text.split()) == 1)


def reads_as_mission(text: str) -> bool:
    """Whether a text is a mission in the words that ship."""
    from btlang.api import parse_tree
    from btlang.diagnostics.errors import MissionError

    try:
        parse_tree(text)
    except MissionError:
        return False
    return True


def quoted(mission: str) -> str:
    """A mission as a word of a shell, in double quotes where these do."""
    return shlex.quote(mission) if set(mission) & set('"$`\\!') else f'"{mission}"'


_DEFAULTS: dict[str, Any] = {
    "as_mission": False,
    "keywords": [], "world": None, "parser": DEFAULT_PARSER, "include_root": None, "speed": "real", "format": "text",
    "main": "", "robot": "simulated", "over": None, "language": ENGLISH,
}  # fmt: skip


_READING = ("check", "compile", "diff", "explain", "format", "grammar", "tree", "words")
"""Verbs that run nothing, but may read missions in the words of a robot."""


def _speed_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--speed", type=speed, default="real", help="real, max, or a factor of real time")


def _repl_options(parser: argparse.ArgumentParser) -> None:
    from btlang.ros.command import add_body_options

    add_reading_options(parser)
    _speed_option(parser)
    add_body_options(parser)


def _run_options(parser: argparse.ArgumentParser) -> None:
    from btlang.recording.options import add_browser_option, add_picture_options, add_recording_options
    from btlang.ros.command import add_robot_options

    add_mission_options(parser)
    _speed_option(parser)
    parser.add_argument(
        "--rate", type=between(*RATES), default=20.0, metavar="HZ", help="ticks per second (default: 20)"
    )
    parser.add_argument(
        "--for", type=duration, dest="time_limit", metavar="DURATION", help="stop after this time, such as 60s or 2min"
    )
    parser.add_argument("--seed", type=int, metavar="N", help="seed of random choices; the log of a run has its seed")
    parser.add_argument("--answers", metavar="FILE", help="TOML file with answers to what the robot asks")
    parser.add_argument("--log", metavar="FILE", help="write every event as a line of JSON")
    add_picture_options(parser)
    parser.add_argument("--voice", metavar="FILE", help="write what the robot says to a WAV file")
    parser.add_argument("--watch", action="store_true", help="show map, text, tree and speech in the browser")
    add_browser_option(parser)
    parser.add_argument("--lines", action="store_true", help="print plain lines, even on a terminal")
    parser.add_argument("--quiet", action="store_true", help="print only errors")
    add_recording_options(parser)
    add_robot_options(parser)


def _elsewhere(module: str, name: str, words: bool = False) -> Callable[[argparse.ArgumentParser], None]:
    """Options that a module adds which only their verb needs, perhaps after those of words."""

    def add(parser: argparse.ArgumentParser) -> None:
        if words:
            add_words_options(parser)
        getattr(import_module(module), name)(parser)

    return add


def _replay_options(parser: argparse.ArgumentParser) -> None:
    from btlang.recording.options import add_replay_options

    _speed_option(parser)
    add_replay_options(parser)


def _examples_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--copy", metavar="FOLDER", help="copy them to a folder, with their worlds")
    parser.add_argument("name", nargs="*", metavar="NAME", help="only these examples")


def _ros_node_options(parser: argparse.ArgumentParser) -> None:
    from btlang.ros.mission.command import add_node_options

    add_reading_options(parser)
    _speed_option(parser)
    add_node_options(parser)


def _help_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("subject", nargs="?", metavar="VERB", help="verb whose options to list")


_RECORDING = "btlang.recording.options"
_OPTIONS: dict[str, tuple[str, Callable[[argparse.ArgumentParser], None]]] = {
    "repl": ("start the prompt, as `btc` alone does", _repl_options),
    "run": ("run a mission on the simulated robot, or a ROS 2 robot", _run_options),
    "replay": ("replay a recorded run", _replay_options),
    "watch": ("show a recorded run in the browser", _elsewhere("btlang.server.options", "add_watch_options")),
    "why": ("explain what happened in a recorded run, and why it failed", _elsewhere(_RECORDING, "add_recording_file")),
    "test": ("run tests of missions, written in English", _elsewhere("btlang.testing.options", "add_test_options")),
    "diff": ("show what differs between two missions, trees or recorded runs", add_diff_options),
    "check": ("report mistakes in missions and trees", add_check_options),
    "tree": ("print the behavior tree of a mission", add_tree_options),
    "compile": ("write the tree of a mission as XML, English, JSON, a picture ...", add_compile_options),
    "words": ("list what missions can say", add_listing_options),
    "grammar": ("write a grammar of missions, for language models", add_grammar_options),
    "robot": (
        "bring a robot up for many tasks, and control it",
        _elsewhere("btlang.task.options", "add_robot_options"),
    ),
    "task": ("give work to a robot that is up", _elsewhere("btlang.task.options", "add_task_options")),
    "world": ("check, draw, import and export world files", _elsewhere("btlang.maps.options", "add_world_options")),
    "gesture": (
        "play, check, draw and record gestures of a robot",
        _elsewhere("btlang.gestures.options", "add_gesture_options"),
    ),
    "components": (
        "list the components and devices of a robot that is up",
        _elsewhere("btlang.task.options", "add_component_options"),
    ),
    "serve": (
        "serve the robots that are up to browsers and programs",
        _elsewhere("btlang.server.options", "add_serve_options"),
    ),
    "user": ("manage the users of btc serve", _elsewhere("btlang.server.options", "add_user_options")),
    "edit": ("write a mission in the browser", _elsewhere("btlang.server.options", "add_edit_options", True)),
    "mcp": ("let language models write and simulate missions, as an MCP server", add_words_options),
    "examples": ("list, print or copy the example missions", _examples_options),
    "new": (
        "create a project: a component, a device or a robot",
        _elsewhere("btlang.templates.options", "add_new_options"),
    ),
    "explain": ("show how a mission is understood, or explain a message code", add_explain_options),
    "format": ("format missions: indentation, spaces, empty lines", add_format_options),
    "sim-ros": (
        "run the simulated robot as a ROS 2 node",
        _elsewhere("btlang.ros.simulator.command", "add_simulator_options"),
    ),
    "ros-node": ("run missions as a ROS 2 node, for other programs", _ros_node_options),
    "ros-devices": (
        "show the devices of a robot as ROS 2 topics",
        _elsewhere("btlang.ros.devices.command", "add_device_options"),
    ),
    "serve-actions": (
        "serve btlang's actions as ROS 2 actions",
        _elsewhere("btlang.ros.serving.command", "add_serving_options", True),
    ),
    "completion": (
        "print a script that completes btc in a shell",
        _elsewhere("btlang.shell_completion", "add_completion_options"),
    ),
    "help": ("show this help, or that of a verb", _help_options),
    "version": ("print the version", lambda _: None),
}


GROUPS = {
    "run and see": ("repl", "run", "examples", "replay", "watch", "why"),
    "write and check": ("check", "tree", "explain", "words", "format", "test", "diff", "edit"),
    "keep a robot up": ("robot", "task", "components", "serve", "user"),
    "build": ("world", "gesture", "new"),
    "share": ("compile", "grammar", "mcp"),
    "ROS 2": ("sim-ros", "ros-node", "ros-devices", "serve-actions"),
    "this command": ("help", "completion", "version"),
}
"""The verbs by what people do with them."""

_ALIASES = {"-h": "help", "--help": "help", "--version": "version"}
