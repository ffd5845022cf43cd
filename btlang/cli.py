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
from btlang.api import Mission, format_mission
from btlang.cli_input import add_robot_files, hinting, mission_of, typed_source
from btlang.cli_options import parsed, show_help, verb_parsers
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import read_source, reason_of
from btlang.diagnostics.report import Report
from btlang.mission_vocabulary import world_vocabulary
from btlang.testing.names import is_test_file
from btlang.text.output import listing_width, pass_on, show
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.registry import Connector

SUCCESS, FAILED, UNFORMATTED, BAD_INPUT, CRASHED, INTERRUPTED = 0, 1, 1, 2, 70, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one verb; returns the exit code.

    0 success or skipped, 1 mission failed, 2 bad input, 3 the robot still moves at the end, 70 a bug in btlang,
    130 interrupted, 131 emergency stop, 143 terminated. With BTC_DEBUG set, what a bug raises comes through.
    """
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal that cannot show a character still gets the rest
    try:
        options = parsed(arguments)
        options.report = Report(options.format, on_output=options.verb in ("check", "world"))
        try:
            add_robot_files(options)
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
            show(f"btc: {reason_of(error)}", stream=sys.stderr)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for stream in (sys.stdout, sys.stderr):
            os.dup2(nowhere, stream.fileno())
        return codes.get(error.errno or 0, BAD_INPUT)
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        if os.environ.get("BTC_DEBUG"):
            raise
        from btlang.diagnostics.crash import crashed

        show(crashed(error), sys.stderr)
        return CRASHED


def _run(options: argparse.Namespace) -> int:
    from btlang.robots.worlds.world_file import read_world
    from btlang.ros.command import chosen_robot, print_preflight

    robot = chosen_robot(options)
    mission = mission_of(options)
    if options.preflight:
        ready = print_preflight(mission.tree, mission.vocabulary, read_world(mission.world, robot.body), robot)
        return SUCCESS if ready else FAILED
    if options.text is not None and robot.over == "simulated":
        _note_robots_up()
    if not options.watch:
        return _run_shown(options, mission, robot)
    from btlang.server.watching import watched

    name = "mission" if options.text is not None or options.file == "-" else os.path.basename(options.file)
    with watched(mission, name, robot.body, robot.over == "simulated", options.browser) as monitor:
        return monitor.stay(_run_shown(options, mission, robot, monitor.opened))


def _run_shown(options: argparse.Namespace, mission: Mission, robot: Connector, *monitors: Callable[..., Any]) -> int:
    """Runs a mission with its pictures and its recording; `monitors` show it elsewhere."""
    from btlang.pictures.command import pictures_of
    from btlang.recording.options import recording
    from btlang.robots.ears import read_answers
    from btlang.robots.voice import voice_track
    from btlang.run.command import run_mission
    from btlang.session import Session

    with (
        pictures_of(mission, options.picture, options.tree_picture, options.quiet) as sinks,
        recording(mission, options) as recorders,
        voice_track(options.voice, robot.body) as voices,
    ):
        return run_mission(
            mission,
            partial(Session, robot, world=mission.world),
            speed=options.speed,
            rate=options.rate,
            time_limit=options.time_limit,
            seed=options.seed,
            answers=options.answers and read_answers(options.answers),
            log=options.log,
            quiet=options.quiet,
            lines=options.lines,
            sinks=[*sinks, *recorders, *voices],
            scans=options.record_scans if recorders else None,
            open_monitors=[*_groot(options.groot), *monitors],
        )


def _note_robots_up() -> None:
    """Says that what is typed moves none of the robots that are up: somebody may want to stop one."""
    from btlang.task.paths import names_up

    if names := names_up():
        who = f"robot '{names[0]}', which is up" if len(names) == 1 else "robots that are up"
        show(
            f"note: this runs in a simulation of its own, not on the {who}. To stop that: btc robot stop. "
            "To give it work: btc task add -c '...'",
            sys.stderr,
        )


def _groot(port: int | None) -> list[Callable[..., Any]]:
    """What shows a run to Groot2, if the options ask for that."""
    if port is None:
        return []
    from btlang.monitor.command import groot_monitor

    return [partial(groot_monitor, port)]


def _show_tree(options: argparse.Namespace) -> int:
    from btlang.tree.dump import plain

    mission = mission_of(options)
    if options.picture is not None:
        _draw_tree(mission, options.picture, options.apart)
        return SUCCESS
    show(plain(mission.tree) if options.plain else mission)
    return SUCCESS


def _draw_tree(mission: Mission, path: str, apart: bool) -> None:
    from btlang.pictures.files import check_picture
    from btlang.pictures.tree_picture import draw_tree

    check_picture(path)
    draw_tree(mission.tree, mission.label, mission.is_action, path, apart=apart)
    show(f"Wrote {path}.")


def _grammar(options: argparse.Namespace) -> int:
    from btlang.backends.files import put
    from btlang.backends.grammar.targets import GRAMMARS

    put(GRAMMARS[options.to](world_vocabulary(options.keywords, options.world, options.language)), options.out)
    return SUCCESS


def _examples(options: argparse.Namespace) -> int:
    from btlang import examples

    chosen = examples.found(options.name) if options.name else examples.all_examples()
    if options.copy is not None:
        written = examples.copied(options.copy, chosen)
        show("\n".join((*written, *examples.beginnings(options.copy, chosen))))
    elif options.name:
        show("\n\n".join(example.text.rstrip("\n") for example in chosen))
    else:
        show("\n".join(examples.listing(listing_width())))
    return SUCCESS


def _explain(options: argparse.Namespace) -> int:
    from btlang.diagnostics.explain import all_codes, explain_code, is_code

    subject = options.file
    if options.text is not None or (subject is not None and not is_code(subject) and _is_file(subject)):
        show(mission_of(options).explain(listing_width(100)))
    elif subject is not None:
        with hinting(subject, "explain"):
            show(explain_code(subject))
    else:
        show(all_codes())
        show("\nTo read one: btc explain CODE")
    return SUCCESS


def _is_file(subject: str) -> bool:
    """Whether it names a file, there or not: a word alone that names none is meant as a code."""
    return subject == "-" or os.path.exists(subject) or (subject != "" and not subject.isalnum())


def _format(options: argparse.Namespace) -> int:
    """Files in place; standard input and a text of the command line to standard output."""
    sources = [partial(read_source, path, options.include_root) for path in options.file]
    if options.text is not None:
        sources = [partial(typed_source, options)]
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
    if is_test_file(source.name):
        from btlang.testing.test_file import format_tests

        text = format_tests(source)
    else:
        text = format_mission(
            source, parser=options.parser, keywords=options.keywords, world=options.world, language=options.language
        )
    changes = text != source.text
    if options.check:
        if changes:
            show(f"{source.name} would change.")
        return changes
    if options.text is not None or source.name == "-":
        pass_on(text)
    elif changes:
        from btlang.backends.files import replace_text

        replace_text(source.name, text)
        show(f"Formatted {source.name}.")
    return False


def _serve(options: argparse.Namespace) -> int:
    code: int = import_module(_ELSEWHERE[options.verb]).serve(options)
    return code


def _repl(options: argparse.Namespace) -> int:
    from btlang.repl.loop import run_repl
    from btlang.ros.command import platform_of

    platform_of(options)
    return run_repl(
        keywords=options.keywords,
        world=options.world,
        parser=options.parser,
        include_root=options.include_root,
        speed=options.speed,
        robot=options.robot,
        language=options.language,
        over=options.over,
    )


def _completion(options: argparse.Namespace) -> int:
    from btlang.examples import all_examples
    from btlang.robots.bodies.body_file import shipped_bodies
    from btlang.robots.platforms import ROBOTS
    from btlang.shell_completion import completion_script
    from btlang.vocabulary.items import items
    from btlang.vocabulary.shipped import languages

    known = {
        "VERB": _VERBS,
        "LANG": languages(),
        "ROBOT": (*ROBOTS, *shipped_bodies()),
        "SPEED": ("real", "max"),
        "SEARCH": dict.fromkeys(item.topic for item in items(world_vocabulary()) if " " not in item.topic),
        "NAME": [example.name for example in all_examples()],
    }
    pass_on(completion_script(options.shell, verb_parsers(), known))
    return SUCCESS


def _robot(options: argparse.Namespace) -> int:
    from btlang.task.applicable import FLEET_ACTS

    module = "btlang.server.fleet_command" if options.act in FLEET_ACTS else "btlang.task.robot_command"
    code: int = import_module(module).serve(options)
    return code


def _help(options: argparse.Namespace) -> int:
    show_help(options.subject)
    return SUCCESS


def _version(options: argparse.Namespace) -> int:
    show(f"btc {btlang.__version__}")
    return SUCCESS


_ELSEWHERE = {
    **dict.fromkeys(("replay", "why", "diff"), "btlang.recording.command"),
    "check": "btlang.cli_check",
    "test": "btlang.testing.command",
    "compile": "btlang.cli_compile",
    "words": "btlang.cli_words",
    "mcp": "btlang.mcp_server",
    "new": "btlang.templates.command",
    "world": "btlang.maps.command",
    "gesture": "btlang.gestures.command",
    "task": "btlang.task.command",
    "components": "btlang.task.component_command",
    "serve": "btlang.server.command",
    "user": "btlang.server.user_command",
    "edit": "btlang.server.edit_command",
    "watch": "btlang.server.watching",
    "sim-ros": "btlang.ros.simulator.command",
    "ros-node": "btlang.ros.mission.command",
    "ros-devices": "btlang.ros.devices.command",
    "serve-actions": "btlang.ros.serving.command",
}
"""The verbs that other modules do, each with the module that has its `serve`."""

_VERBS: dict[str, Callable[[argparse.Namespace], int]] = {
    "repl": _repl,
    "run": _run,
    "tree": _show_tree,
    "grammar": _grammar,
    "examples": _examples,
    "explain": _explain,
    "format": _format,
    **dict.fromkeys(_ELSEWHERE, _serve),
    "robot": _robot,
    "completion": _completion,
    "help": _help,
    "version": _version,
}
