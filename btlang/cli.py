"""The `btc` command: thin verbs over the library."""

from __future__ import annotations

import argparse
import errno
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module

import btlang
from btlang.api import RATES, RunnableTree, format_mission, parse_tree, read_world, world_vocabulary
from btlang.arguments import between, duration, picture, speed
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.reading import read_source, reason_of
from btlang.diagnostics.report import FORMATS, Report
from btlang.frontends.mission import DEFAULT_PARSER, PARSERS
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

SUCCESS, FAILED, UNFORMATTED, BAD_INPUT, INTERRUPTED = 0, 1, 1, 2, 130
_WIDEST = 120  # columns; longer lines are hard to read


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one verb; returns the exit code.

    0 success or skipped, 1 mission failed, 2 bad input, 130 interrupted, 131 emergency stop, 143 terminated.
    """
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal that cannot show a character still gets the rest
    try:
        options = _parsed(arguments)
        options.report = Report(options.format, on_output=options.verb == "check")
        try:
            code = _VERBS[options.verb](options)
        except MissionError as error:
            options.report.add(error.diagnostics)
            code = BAD_INPUT
        options.report.close()
        if sys.stdout is not None:
            sys.stdout.flush()
        return code
    except OSError as error:
        # the reader of our output has seen enough, or the terminal is gone
        codes = {errno.EPIPE: SUCCESS, errno.EIO: INTERRUPTED}
        if error.errno not in codes:
            print(f"btc: {reason_of(error)}", file=sys.stderr)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for stream in (sys.stdout, sys.stderr):
            os.dup2(nowhere, stream.fileno())
        return codes.get(error.errno or 0, BAD_INPUT)
    except KeyboardInterrupt:
        return INTERRUPTED


def _run(options: argparse.Namespace) -> int:
    from btlang.pictures.command import pictures_of
    from btlang.ros.command import chosen_robot, print_preflight
    from btlang.run.command import run_mission

    robot = chosen_robot(options)
    tree = _tree(options)
    if options.preflight:
        ready = print_preflight(tree.tree, tree.vocabulary, read_world(options.world), robot)
        return SUCCESS if ready else FAILED
    with pictures_of(tree, options.picture, options.tree_picture) as sinks:
        return run_mission(
            tree,
            speed=options.speed,
            rate=options.rate,
            time_limit=options.time_limit,
            log=options.log,
            quiet=options.quiet,
            lines=options.lines,
            sinks=sinks,
            robot=robot,
        )


def _check(options: argparse.Namespace) -> int:
    _tree(options)
    if not options.report.is_json:
        print("The mission is fine.")
    return SUCCESS


def _show_tree(options: argparse.Namespace) -> int:
    from btlang.tree.dump import plain

    tree = _tree(options)
    if options.picture is not None:
        _draw_tree(tree, options.picture, options.apart)
        return SUCCESS
    print(plain(tree.tree) if options.plain else tree)
    return SUCCESS


def _draw_tree(tree: RunnableTree, path: str, apart: bool) -> None:
    from btlang.pictures.files import check_picture
    from btlang.pictures.tree_picture import draw_tree

    check_picture(path)
    draw_tree(tree.tree, tree.label, tree.is_action, path, apart=apart)
    print(f"The tree is drawn in {path}.")


def _words(options: argparse.Namespace) -> int:
    from btlang.vocabulary.listing import listing

    lines = listing(world_vocabulary(options.keywords, options.world), " ".join(options.search))
    print("\n".join(lines))
    return SUCCESS


def _examples(options: argparse.Namespace) -> int:
    from btlang import examples

    chosen = examples.found(options.name) if options.name else examples.examples()
    if options.copy is not None:
        written = examples.copied(options.copy, chosen)
        print("\n".join((*written, f"The command at the top of each mission runs it in the folder {options.copy}.")))
    elif options.name:
        print("\n\n".join(example.text.rstrip("\n") for example in chosen))
    else:
        print("\n".join(examples.listing()))
    return SUCCESS


def _explain(options: argparse.Namespace) -> int:
    from btlang.diagnostics.explain import all_codes, explain_code, is_code

    subject = options.file
    if options.text is not None or (subject is not None and not is_code(subject) and _is_file(subject)):
        return _explain_mission(options)
    print(all_codes() if subject is None else explain_code(subject))
    return SUCCESS


def _is_file(subject: str) -> bool:
    """Whether it names a file, there or not: a word alone that names none is meant as a code."""
    return subject == "-" or os.path.exists(subject) or (subject != "" and not subject.isalnum())


def _explain_mission(options: argparse.Namespace) -> int:
    from shutil import get_terminal_size

    width = get_terminal_size((100, 24)).columns
    print(_tree(options).explain(min(width, _WIDEST)))
    return SUCCESS


def _format(options: argparse.Namespace) -> int:
    """Files in place; standard input and a text of the command line to standard output."""
    sources = [partial(read_source, path) for path in options.file]
    if options.text is not None:
        sources = [partial(Source, options.text, "<command line>")]
    code = SUCCESS
    for read in sources:
        try:
            if _format_one(read(), options):
                code = code or UNFORMATTED
        except MissionError as error:
            options.report.add(error.diagnostics)
            code = BAD_INPUT
    return code


def _format_one(source: Source, options: argparse.Namespace) -> bool:
    """Whether `--check` found that the text would change."""
    text = format_mission(source, parser=options.parser, keywords=options.keywords, world=options.world)
    changes = text != source.text
    if options.check:
        if changes:
            print(f"{source.name} would change.")
        return changes
    if options.text is not None or source.name == "-":
        print(text, end="")
    elif changes:
        from btlang.backends.mission_file import replace_text

        replace_text(source.name, text)
        print(f"{source.name} is laid out anew.")
    return False


def _node(options: argparse.Namespace) -> int:
    code: int = import_module(_NODES[options.verb]).serve(options)
    return code


def _repl(options: argparse.Namespace) -> int:
    from btlang.repl.loop import run_repl

    return run_repl(keywords=options.keywords, world=options.world, parser=options.parser, speed=options.speed)


_NODES = {
    "sim-ros": "btlang.ros.simulator.command",
    "ros-node": "btlang.ros.mission.command",
    "serve-actions": "btlang.ros.serving.command",
}
"""The verbs that are nodes of ROS 2, each with the module whose `serve` it is."""

_VERBS: dict[str, Callable[[argparse.Namespace], int]] = {
    "repl": _repl,
    "run": _run,
    "check": _check,
    "tree": _show_tree,
    "words": _words,
    "examples": _examples,
    "explain": _explain,
    "format": _format,
    **dict.fromkeys(_NODES, _node),
}


def _tree(options: argparse.Namespace) -> RunnableTree:
    """Compiles what the options name; warnings go to the report."""
    source = Source(options.text, "<command line>") if options.text is not None else read_source(options.file)
    tree = parse_tree(source, parser=options.parser, keywords=options.keywords, world=options.world)
    for warning in tree.warnings:
        options.report.add([warning])
    return tree


def _parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The options of the command line. Only those of its verb are made: making all takes a tenth of `btc check`."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    if words and words[0] in _OPTIONS:
        parser = _Parser(f"btc {words[0]}")
        parser.set_defaults(**_DEFAULTS, verb=words[0])
        _OPTIONS[words[0]][1](parser)
        return parser.parse_args(words[1:])
    parser = _Parser("btc", description="Compiles and runs robot missions in plain English.")
    parser.add_argument("--version", action="version", version=f"btc {btlang.__version__}")
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", prog="btc", parser_class=_Parser)
    parser.set_defaults(**_DEFAULTS, verb="repl")  # behind the verbs, which have none as default
    for verb, (about, add) in _OPTIONS.items():
        add(verbs.add_parser(verb, help=about))
    return parser.parse_args(words)


_DEFAULTS: dict[str, Any] = {
    "keywords": [], "world": None, "parser": DEFAULT_PARSER, "speed": "real", "format": "text"
}  # fmt: skip


def _words_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--keywords", action="append", default=[], metavar="FILE", help="further keyword file, or name of a pack"
    )
    _world_option(parser)


def _world_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--world", metavar="FILE", help="world file (default: the world that ships)")


def _reading_options(parser: argparse.ArgumentParser) -> None:
    _words_options(parser)
    parser.add_argument("--parser", choices=list(PARSERS), default=DEFAULT_PARSER, help="(default: %(default)s)")


def _mission_options(parser: argparse.ArgumentParser) -> None:
    _reading_options(parser)
    parser.add_argument(
        "--format", choices=FORMATS, default="text", help="of messages: text, or json for programs (default: text)"
    )
    text = parser.add_mutually_exclusive_group(required=True)
    text.add_argument("file", nargs="?", metavar="FILE", help="mission, or - for standard input")
    text.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def _speed_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--speed", type=speed, default="real", help="real, max, or a factor of real time")


def _repl_options(parser: argparse.ArgumentParser) -> None:
    _reading_options(parser)
    _speed_option(parser)


def _run_options(parser: argparse.ArgumentParser) -> None:
    from btlang.ros.command import add_robot_options

    _mission_options(parser)
    _speed_option(parser)
    parser.add_argument("--rate", type=between(*RATES), default=20.0, metavar="HZ", help="ticks a second (default: 20)")
    parser.add_argument("--for", type=duration, dest="time_limit", metavar="DURATION", help="stop after e.g. 60s, 2min")
    parser.add_argument("--log", metavar="FILE", help="write every event as a line of JSON")
    parser.add_argument(
        "--picture", type=picture(".svg", ".png", ".gif"), metavar="FILE", help="draw the run: .svg, .png or .gif"
    )
    parser.add_argument(
        "--tree-picture", type=picture(".svg", ".png"), metavar="FILE", help="draw the tree and how its nodes ended"
    )
    parser.add_argument("--lines", action="store_true", help="plain lines also where the output is a terminal")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    add_robot_options(parser)


def _tree_options(parser: argparse.ArgumentParser) -> None:
    _mission_options(parser)
    parser.add_argument("--plain", action="store_true", help="one line a node: Id port=value")
    parser.add_argument("--picture", type=picture(".svg", ".png"), metavar="FILE", help="draw the tree: .svg or .png")
    parser.add_argument("--apart", action="store_true", help="draw each named subtree once, below the tree")


def _listing_options(parser: argparse.ArgumentParser) -> None:
    _words_options(parser)
    parser.add_argument("search", nargs="*", metavar="SEARCH", help="only this topic, or what has these words")


def _examples_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--copy", metavar="FOLDER", help="copy them to a folder, with the worlds that they need")
    parser.add_argument("name", nargs="*", metavar="NAME", help="only these")


def _explain_options(parser: argparse.ArgumentParser) -> None:
    _reading_options(parser)
    subject = parser.add_mutually_exclusive_group()
    subject.add_argument("file", nargs="?", metavar="FILE|CODE", help="mission, - for standard input, or e.g. BT013")
    subject.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def _format_options(parser: argparse.ArgumentParser) -> None:
    _reading_options(parser)
    parser.add_argument("--check", action="store_true", help="change nothing; exit with 1 where a file would change")
    several = parser.add_mutually_exclusive_group(required=True)
    several.add_argument("file", nargs="*", default=[], metavar="FILE", help="mission, or - for standard input")
    several.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def _sim_ros_options(parser: argparse.ArgumentParser) -> None:
    from btlang.ros.simulator.command import add_simulator_options

    _world_option(parser)
    add_simulator_options(parser)


def _ros_node_options(parser: argparse.ArgumentParser) -> None:
    from btlang.ros.mission.command import add_node_options

    _reading_options(parser)
    _speed_option(parser)
    add_node_options(parser)


def _serving_options(parser: argparse.ArgumentParser) -> None:
    from btlang.ros.serving.command import add_serving_options

    _words_options(parser)
    add_serving_options(parser)


_OPTIONS: dict[str, tuple[str, Callable[[argparse.ArgumentParser], None]]] = {
    "repl": ("type a mission line by line; what `btc` alone does", _repl_options),
    "run": ("run a mission on the simulated robot, or a ROS 2 robot", _run_options),
    "check": ("say what is wrong with a mission", _mission_options),
    "tree": ("print the behavior tree of a mission", _tree_options),
    "words": ("list what can be said", _listing_options),
    "examples": ("list the missions that ship, print them or copy them", _examples_options),
    "explain": ("show how a mission is read, or tell of a message", _explain_options),
    "format": ("lay out missions: indentation, spaces, empty lines", _format_options),
    "sim-ros": ("offer the simulated robot over ROS 2", _sim_ros_options),
    "ros-node": ("run missions as a ROS 2 node, for other programs", _ros_node_options),
    "serve-actions": ("serve what the robot can do as ROS 2 actions", _serving_options),
}


class _Help(argparse.HelpFormatter):
    """Asks for the width of the terminal only to print: argparse makes one for each option that it is told of."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, width=_WIDEST)

    def format_help(self) -> str:
        from shutil import get_terminal_size

        self._width = get_terminal_size().columns - 2
        return super().format_help()


class _Parser(argparse.ArgumentParser):
    def __init__(self, prog: str | None = None, **options: Any) -> None:
        super().__init__(prog, formatter_class=_Help, **options)


if __name__ == "__main__":
    sys.exit(main())
