"""Missions as options name them: their source, and what is read from it."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from contextlib import contextmanager

from btlang.api import Mission, parse_tree
from btlang.cli.parser import looks_like_path, quote_mission, reads_as_mission
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import read_source
from btlang.passes.lint.tree_lints import UNDECLARED
from btlang.robots.platforms import ROBOTS
from btlang.support.test_files import is_test_file
from btlang.text.source import Source, Span
from btlang.vocabulary.shipped import shipped

_OWN_ROBOT = ("robot", "gesture")  # these verbs read the robot themselves


def read_typed(options: argparse.Namespace) -> Source:
    """Return the text of the option -c, whose folder is the current one."""
    roots = None if options.include_root is None else ("", options.include_root)
    return Source(options.text, "<command line>", roots=roots, may_load=True)


def add_robot_files(options: argparse.Namespace) -> None:
    """Add the keyword files of a robot's components to those of --keywords, and its world where --world names none."""
    robot = getattr(options, "robot", "")
    if options.verb not in _OWN_ROBOT and hasattr(options, "keywords") and robot not in ("", *ROBOTS):
        from btlang.components.words import words_of
        from btlang.robots.registry import body_of

        body = body_of(robot)
        options.keywords = [*words_of(body), *options.keywords]
        options.world = options.world or body.world or None


def mission_of(options: argparse.Namespace, source: Source | None = None, *, tells_undeclared: bool = True) -> Mission:
    """Compile what the options name; warnings go to the report. Raises MissionError.

    `tells_undeclared` is False where undeclared nodes are errors next, or are those of another program.
    """
    mission = parse_mission(source_of(options) if source is None else source, options)
    options.report.add(each for each in mission.warnings if tells_undeclared or each.code != UNDECLARED)
    return mission


def source_of(options: argparse.Namespace) -> Source:
    """Read the text of the file, or that of the option -c. Raises MissionError."""
    return read_typed(options) if options.text is not None else _read_file(options)


def parse_mission(source: Source, options: argparse.Namespace) -> Mission:
    """Compile a text with these options. Raises MissionError."""
    if is_test_file(source.name):
        raise MissionError([diagnostic("BT183", Span(source, 0, 0), file=source.name)])
    try:
        return parse_tree(
            source, parser=options.parser, keywords=options.keywords, world=options.world, main=options.main,
            language=options.language, has_robot=getattr(options, "robot", "") not in ("", *ROBOTS),
        )  # fmt: skip
    except MissionError as error:
        advice = options.report.advice or _advice_on_robot(source.name, options)
        options.report.advice = advice or _advice_on_world(error, source, options)
        raise


def _advice_on_robot(path: str, options: argparse.Namespace) -> str:
    """Advise a robot file beside or above the mission that isn't chosen: it may have the words and places."""
    if getattr(options, "robot", None) not in ("", *ROBOTS) or options.world or not os.path.isfile(path):
        return ""
    folder = os.path.dirname(path)
    for file in (os.path.join(folder, "robot.toml"), os.path.normpath(os.path.join(folder, "..", "robot.toml"))):
        if os.path.isfile(file):
            from shlex import quote

            return f"If the mission is for the robot in {file}, add: --robot {quote(file)}"
    return ""


def _advice_on_world(error: MissionError, source: Source, options: argparse.Namespace) -> str:
    """Advise a world that ships if it has the names that the world of the mission lacks."""
    lacking = [dict(problem.arguments).get("words", "") for problem in error.diagnostics if problem.code == "BT013"]
    if options.world or options.main or not lacking:
        return ""
    from glob import glob
    from shlex import quote

    for path in sorted(glob(os.path.join(shipped("examples", "worlds"), "*.toml"))):
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
    """Read the file, or the example of this name. The error may say how to give a mission as text."""
    name = options.file
    with hint_at_text(name, options.verb):
        try:
            return read_source(_example(name) or name, options.include_root)
        except MissionError as error:
            if not name.isidentifier() or os.path.lexists(name) or reads_as_mission(name):
                raise
            from btlang.cli.examples import describe_near

            advice = describe_near(name)
            raise error.advising(advice) if advice else error from None


def _example(name: str) -> str:
    """Return the file of a shipped mission, unless there is a file of its name here."""
    if os.path.lexists(name) or not name.isidentifier():
        return ""
    from btlang.cli.examples import path_of

    return path_of(name)


@contextmanager
def hint_at_text(subject: str, verb: str) -> Iterator[None]:
    """Add to errors about a subject that isn't a file, but several words or a mission, how to give it as text."""
    try:
        yield
    except MissionError as error:
        has_mistakes = " " in subject.strip() and not looks_like_path(subject)
        if os.path.exists(subject) or not (has_mistakes or reads_as_mission(subject)):
            raise
        raise error.advising(f"To give a mission as text: btc {verb} -c {quote_mission(subject)}") from None
