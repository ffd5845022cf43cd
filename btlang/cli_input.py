"""What the options of a verb name: the source of a mission, and the mission."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from contextlib import contextmanager

from btlang.api import Mission, parse_tree
from btlang.cli_options import quoted, reads_as_mission
from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import read_source
from btlang.robots.platforms import ROBOTS
from btlang.testing.names import is_test_file
from btlang.text.source import Source, Span
from btlang.vocabulary.shipped import shipped

_OWN_ROBOT = ("robot", "gesture")  # these verbs read the robot themselves


def typed_source(options: argparse.Namespace) -> Source:
    """The text of the option -c, whose folder is the current one."""
    roots = None if options.include_root is None else ("", options.include_root)
    return Source(options.text, "<command line>", roots=roots, may_load=True)


def add_robot_files(options: argparse.Namespace) -> None:
    """The words of a robot's components count as those of --keywords do, and its world as that of --world where none is
    given, in every verb that takes these.
    """
    robot = getattr(options, "robot", "")
    if options.verb not in _OWN_ROBOT and hasattr(options, "keywords") and robot not in ("", *ROBOTS):
        from btlang.components.words import words_of
        from btlang.robots.registry import body_of

        body = body_of(robot)
        options.keywords = [*words_of(body), *options.keywords]
        options.world = options.world or body.world or None


def mission_of(options: argparse.Namespace, source: Source | None = None) -> Mission:
    """Compiles what the options name; warnings go to the report. Raises MissionError."""
    mission = parsed_mission(source_of(options) if source is None else source, options)
    options.report.add(mission.warnings)
    return mission


def source_of(options: argparse.Namespace) -> Source:
    """The text of the file, or that of the option -c. Raises MissionError."""
    return typed_source(options) if options.text is not None else _read_file(options)


def parsed_mission(source: Source, options: argparse.Namespace) -> Mission:
    """The mission that a text is with these options. Raises MissionError."""
    if is_test_file(source.name):
        raise MissionError([diagnostic("BT183", Span(source, 0, 0), file=source.name)])
    try:
        return parse_tree(
            source, parser=options.parser, keywords=options.keywords, world=options.world, main=options.main,
            language=options.language,
        )  # fmt: skip
    except MissionError as error:
        advice = options.report.advice or _advice_on_robot(source.name, options)
        options.report.advice = advice or _advice_on_world(error, source, options)
        raise


def _advice_on_robot(path: str, options: argparse.Namespace) -> str:
    """For a mission beside or below the file of a robot that isn't chosen: its words and places may be that robot's."""
    if getattr(options, "robot", None) not in ("", *ROBOTS) or options.world or not os.path.isfile(path):
        return ""
    folder = os.path.dirname(path)
    for file in (os.path.join(folder, "robot.toml"), os.path.normpath(os.path.join(folder, "..", "robot.toml"))):
        if os.path.isfile(file):
            from shlex import quote

            return f"If the mission is for the robot in {file}, add: --robot {quote(file)}"
    return ""


def _advice_on_world(error: MissionError, source: Source, options: argparse.Namespace) -> str:
    """For a mission with names that the world lacks, and one that ships has."""
    lacking = [dict(problem.arguments).get("words", "") for problem in error.diagnostics if problem.code == "BT013"]
    if options.world or options.main or not lacking:
        return ""
    from glob import glob
    from shlex import quote

    for path in sorted(glob(shipped("examples", "worlds", "*.toml"))):
        with open(path, encoding="utf-8") as file:
            text = file.read().lower()
        if all(f'"{words.lower()}"' in text for words in lacking):
            try:
                parse_tree(source, keywords=options.keywords, world=path, language=options.language)
            except MissionError:
                continue
            return f"A world that ships has these names. To use it, add: --world {quote(path)}"
    return ""


def _read_file(options: argparse.Namespace) -> Source:
    """The text of the file, or of the example of this name. The error may say how to give a mission as text."""
    with hinting(options.file, options.verb):
        return read_source(_example(options.file) or options.file, options.include_root)


def _example(name: str) -> str:
    """The file of a shipped mission, unless there is a file of its name here."""
    if os.path.lexists(name) or not name.isidentifier():
        return ""
    from btlang.examples import path_of

    return path_of(name)


@contextmanager
def hinting(subject: str, verb: str) -> Iterator[None]:
    """Adds to errors about a subject that isn't a file, but reads as a mission, how to give it as text."""
    try:
        yield
    except MissionError as error:
        if os.path.exists(subject) or not reads_as_mission(subject):
            raise
        advice = ("help", f"To give a mission as text: btc {verb} -c {quoted(subject)}")
        raise MissionError([p.replace(arguments=(*p.arguments, advice)) for p in error.diagnostics]) from None
