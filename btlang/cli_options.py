"""The options of each verb of the `btc` command."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from itertools import takewhile

from btlang.arguments import between, duration, picture, speed
from btlang.diagnostics.report import CHECK_FORMATS, FORMATS
from btlang.frontends.mission.reader import DEFAULT_PARSER, PARSERS
from btlang.option_parser import OptionParser
from btlang.robots.options import add_robot_words, add_world
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
    parser = OptionParser("btc", usage=usage, description="Compiles and runs robot missions in plain English.")
    verbs = parser.add_subparsers(metavar="VERB", title="verbs", description="btc help VERB lists its options.")
    for verb, (about, _) in _OPTIONS.items():
        verbs.add_parser(verb, help=about)
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


def _words_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--keywords",
        action="append",
        default=[],
        metavar="FILE",
        help="another keyword file, or the name of a pack; may be repeated",
    )
    parser.add_argument(
        "--language", default=ENGLISH, metavar="LANG", help="of the mission: en, es, or a folder (default: en)"
    )
    add_world(parser)


def _reading_options(parser: argparse.ArgumentParser) -> None:
    _words_options(parser)
    parser.add_argument(
        "--parser",
        choices=list(PARSERS),
        default=DEFAULT_PARSER,
        help="how to parse; both give the same tree (default: %(default)s)",
    )
    parser.add_argument("--include-root", metavar="DIR", help="missions may also include files below DIR")


def _main_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--main", default="", metavar="ID", help="which tree to use if the file holds several")


def _mission_options(parser: argparse.ArgumentParser, *, several: bool = False) -> None:
    _reading_options(parser)
    about = "format of messages: text, or json for programs (default: text)"
    parser.add_argument("--format", choices=FORMATS, default="text", help=about)
    _main_option(parser)
    text = parser.add_mutually_exclusive_group(required=True)
    files: dict[str, Any] = {"nargs": "*", "default": []} if several else {"nargs": "?"}
    text.add_argument("file", **files, metavar="FILE", help="mission, or - for standard input")
    text.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def _check_options(parser: argparse.ArgumentParser) -> None:
    _reading_options(parser)
    about = "format of messages: text; json, sarif or github for programs (default: text)"
    parser.add_argument("--format", choices=CHECK_FORMATS, default="text", help=about)
    _main_option(parser)
    parser.add_argument(
        "--models",
        action="append",
        default=[],
        metavar="FILE",
        help="XML file with models of nodes (TreeNodesModel); may be repeated",
    )
    parser.add_argument("--fix", action="store_true", help="write the corrections that are certain into the files")
    parser.add_argument("--then", action="store_true", help="write 'then' where 'and' stands on the way (BT069)")
    several = parser.add_mutually_exclusive_group(required=True)
    about = "mission, tree or folder of trees, or - for standard input; all XML files are one project"
    several.add_argument("file", nargs="*", default=[], metavar="FILE", help=about)
    several.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def _speed_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--speed", type=speed, default="real", help="real, max, or a factor of real time")


def _repl_options(parser: argparse.ArgumentParser) -> None:
    from btlang.ros.command import add_body_options

    _reading_options(parser)
    _speed_option(parser)
    add_body_options(parser)


def _run_options(parser: argparse.ArgumentParser) -> None:
    from btlang.recording.options import add_recording_options
    from btlang.ros.command import add_robot_options

    _mission_options(parser)
    _speed_option(parser)
    parser.add_argument(
        "--rate", type=between(*RATES), default=20.0, metavar="HZ", help="ticks per second (default: 20)"
    )
    parser.add_argument(
        "--for", type=duration, dest="time_limit", metavar="DURATION", help="stop after this time, such as 60s or 2min"
    )
    parser.add_argument(
        "--seed", type=int, metavar="N", help="repeat what an earlier run did by chance: its log has the seed"
    )
    parser.add_argument("--answers", metavar="FILE", help="answer what the robot asks from a TOML file")
    parser.add_argument("--log", metavar="FILE", help="write every event as a line of JSON")
    parser.add_argument(
        "--picture", type=picture(".svg", ".png", ".gif"), metavar="FILE", help="draw the run: .svg, .png or .gif"
    )
    parser.add_argument(
        "--tree-picture", type=picture(".svg", ".png"), metavar="FILE", help="draw the tree with every final status"
    )
    parser.add_argument("--voice", metavar="FILE", help="write what the robot says as sound: a WAV file")
    parser.add_argument("--lines", action="store_true", help="print plain lines, even on a terminal")
    parser.add_argument("--quiet", action="store_true", help="print only errors")
    add_recording_options(parser)
    add_robot_options(parser)


def _elsewhere(module: str, name: str, words: bool = False) -> Callable[[argparse.ArgumentParser], None]:
    """Options that a module adds which only their verb needs, perhaps after those of words."""

    def add(parser: argparse.ArgumentParser) -> None:
        if words:
            _words_options(parser)
        getattr(import_module(module), name)(parser)

    return add


def _replay_options(parser: argparse.ArgumentParser) -> None:
    from btlang.recording.options import add_replay_options

    _speed_option(parser)
    add_replay_options(parser)


def _diff_options(parser: argparse.ArgumentParser) -> None:
    _words_options(parser)
    parser.add_argument("--markdown", action="store_true", help="print a list in Markdown, such as for a pull request")
    parser.add_argument("old", metavar="OLD", help="mission, tree in XML or JSON, or recording")
    parser.add_argument("new", metavar="NEW", help="what to compare with it")


def _tree_options(parser: argparse.ArgumentParser) -> None:
    _mission_options(parser)
    parser.add_argument("--plain", action="store_true", help="one line per node: Id port=value")
    parser.add_argument("--picture", type=picture(".svg", ".png"), metavar="FILE", help="draw the tree: .svg or .png")
    parser.add_argument("--apart", action="store_true", help="draw each named subtree once, below the tree")


def _compile_options(parser: argparse.ArgumentParser) -> None:
    from btlang.backends.targets import TARGETS

    _mission_options(parser, several=True)
    parser.add_argument("--to", choices=list(TARGETS), metavar="TARGET", help="target: " + ", ".join(TARGETS))
    parser.add_argument(
        "-o",
        dest="out",
        metavar="OUT",
        help="file to write (with markdown: or folder); its ending can select the target",
    )
    parser.add_argument("--dialect", type=int, choices=(3, 4), help="BehaviorTree.CPP version of the XML (default: 4)")
    parser.add_argument(
        "--onto", metavar="XML", help="the file that the mission was made from: changes what was edited"
    )
    parser.add_argument("--force", action="store_true", help="with --onto: also where the file has changed since then")


def _listing_options(parser: argparse.ArgumentParser) -> None:
    _words_options(parser)
    parser.add_argument("--all", action="store_true", help="list everything, with what it does and an example")
    about = "make words for the nodes of this XML file, by its TreeNodesModel and its trees; may be repeated"
    parser.add_argument("--from", dest="sources", action="append", default=[], metavar="XML", help=about)
    parser.add_argument("-o", dest="out", metavar="FILE", help="with --from: keyword file (default: standard output)")
    parser.add_argument("search", nargs="*", metavar="SEARCH", help="a topic, or words to search for")


def _grammar_options(parser: argparse.ArgumentParser) -> None:
    from btlang.backends.grammar.targets import GRAMMARS

    _words_options(parser)
    parser.add_argument("--to", choices=list(GRAMMARS), default="gbnf", help="form of the grammar (default: gbnf)")
    parser.add_argument("-o", dest="out", metavar="FILE", help="file to write (default: standard output)")


def _examples_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--copy", metavar="FOLDER", help="copy them to a folder, with their worlds")
    parser.add_argument("name", nargs="*", metavar="NAME", help="only these examples")


def _explain_options(parser: argparse.ArgumentParser) -> None:
    _reading_options(parser)
    _main_option(parser)
    subject = parser.add_mutually_exclusive_group()
    subject.add_argument(
        "file", nargs="?", metavar="FILE|CODE", help="mission, - for standard input, or a code such as BT013"
    )
    subject.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def _format_options(parser: argparse.ArgumentParser) -> None:
    _reading_options(parser)
    parser.add_argument("--check", action="store_true", help="change nothing; exit with 1 if a file would change")
    several = parser.add_mutually_exclusive_group(required=True)
    several.add_argument("file", nargs="*", default=[], metavar="FILE", help="mission, or - for standard input")
    several.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def _ros_node_options(parser: argparse.ArgumentParser) -> None:
    from btlang.ros.mission.command import add_node_options

    _reading_options(parser)
    _speed_option(parser)
    add_node_options(parser)


def _help_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("subject", nargs="?", metavar="VERB", help="whose options to list")


_RECORDING = "btlang.recording.options"
_OPTIONS: dict[str, tuple[str, Callable[[argparse.ArgumentParser], None]]] = {
    "repl": ("type a mission line by line, as with `btc` alone", _repl_options),
    "run": ("run a mission on the simulated robot, or a ROS 2 robot", _run_options),
    "replay": ("show a recorded run as it was", _replay_options),
    "why": ("tell what happened in a recorded run, and why it failed", _elsewhere(_RECORDING, "add_recording_file")),
    "test": ("run tests of missions, written in English", _elsewhere("btlang.testing.options", "add_test_options")),
    "diff": ("tell what differs between two missions, trees or recorded runs", _diff_options),
    "check": ("report the mistakes in missions and trees", _check_options),
    "tree": ("print the behavior tree of a mission", _tree_options),
    "compile": ("write the tree of a mission as XML, English, JSON, a picture ...", _compile_options),
    "words": ("list what missions can say", _listing_options),
    "grammar": ("write a grammar of missions, for language models", _grammar_options),
    "robot": ("keep a robot up for many tasks of many people", _elsewhere("btlang.task.options", "add_robot_options")),
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
    "serve": ("let others reach the robots that are up", _elsewhere("btlang.server.options", "add_serve_options")),
    "user": ("say who may come in through btc serve", _elsewhere("btlang.server.options", "add_user_options")),
    "edit": ("write a mission in the browser", _elsewhere("btlang.server.options", "add_edit_options", True)),
    "mcp": ("let language models write and simulate missions, as an MCP server", _words_options),
    "examples": ("list, print or copy the example missions", _examples_options),
    "new": ("begin a component, a device or a robot", _elsewhere("btlang.templates.options", "add_new_options")),
    "explain": ("show how a mission is understood, or explain a message code", _explain_options),
    "format": ("format missions: indentation, spaces, empty lines", _format_options),
    "sim-ros": (
        "run the simulated robot as a ROS 2 node",
        _elsewhere("btlang.ros.simulator.command", "add_simulator_options"),
    ),
    "ros-node": ("run missions for other programs, as a ROS 2 node", _ros_node_options),
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


_ALIASES = {"-h": "help", "--help": "help", "--version": "version"}
