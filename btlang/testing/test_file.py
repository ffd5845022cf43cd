"""Reads files of tests. A line of a test begins with one of a few words; the rest of it is the English of missions.

test "it goes to charge when it is tired":
  in the world "museum.toml" with the battery at 25%
  run "museum_guide.txt"
  after 30 s the battery drops to 15%
  then within 2 minutes the robot is charging
  finally the mission succeeds and it has never bumped
"""

from __future__ import annotations

import os
from collections.abc import Iterator

from btlang.api import Mission, parse_tree
from btlang.components.words import words_of
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.diagnostics.files import OUTSIDE, included_path, is_within, read_source
from btlang.frontends.mission.symbols.needs import WORDS as NEEDED_WORDS
from btlang.house_rules import read_house_rules
from btlang.printer.layout import format_layout
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.robots.registry import body_of
from btlang.support.record import Record
from btlang.testing.english import MissionEnglish, move_problem
from btlang.testing.gauges import gauge_words
from btlang.testing.statements import ScriptStatement, statements_of
from btlang.testing.test import MissionTest
from btlang.text.source import Source, Span
from btlang.text.words import Line, Words, split
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeAlias

    from btlang.robots.bodies.body import Body

    Given: TypeAlias = Callable[[str, str | None], Mission | None]

WORDS = os.path.join(os.path.dirname(__file__), "words.toml")
"""The keyword file with the words that only tests have."""


def read_tests(source: Source, given: Given = lambda name, world: None) -> tuple[MissionTest, ...]:
    """Return the tests of a file, with their missions.

    `given` has missions that aren't read from files: by the name that follows `run`, and the path of the world that the
    test names, if it does. Raises MissionError with what is wrong.
    """
    vocabulary = load_vocabulary([WORDS])
    text = split(source, vocabulary.orthography)
    problems = [diagnostic("BT004", span) for span in text.open_quotes]
    found: list[MissionTest] = []
    for block in _blocks(text, problems):
        try:
            found.append(_TestFileReader(text, block, vocabulary, given).test())
        except MissionError as error:
            problems += error.diagnostics
    if not found and not problems:
        problems.append(_problem("BT181", Span(source, 0, 0), "there is no test in this file", 'test "it waves":'))
    if problems:
        raise MissionError(sorted(problems, key=lambda one: one.span.start if one.span.source is source else -1))
    return tuple(found)


def check_tests(source: Source) -> list[Diagnostic]:
    """Return the warnings of the missions of a file of tests. Raises MissionError with all that is wrong."""
    return [warning for test in read_tests(source) for warning in test.mission.warnings]


def format_tests(source: Source) -> str:
    """Return the text in the canonical layout of missions. Raises MissionError where its tests can't be read."""
    read_tests(source)
    return format_layout(source, load_vocabulary().orthography)


def find_tests(source: Source) -> list[tuple[str, Span]]:
    """Return the names of the tests of a file, each with the line that begins it, also where tests can't be read."""
    blocks = _blocks(split(source, load_vocabulary([WORDS]).orthography), [])
    return [(block.name, block.span) for block in blocks]


class _Block(Record):
    """A test: its name, the line that begins it, and the words of its other lines."""

    name: str
    span: Span
    lines: tuple[Line, ...]


def _blocks(text: Words, problems: list[Diagnostic]) -> Iterator[_Block]:
    """Yield the tests of a text, by their first lines."""
    heads = [number for number, line in enumerate(text.lines) if line.indent <= text.lines[0].indent]
    for at, number in enumerate(heads):
        line = text.lines[number]
        words = text.words[line.first : line.last]
        span = text.span(line.first, line.last)
        if len(words) != 3 or words[0] != "test" or words[1][0] != '"' or words[2] != ":":
            problems.append(diagnostic("BT180", span, words=span.text, wanted='test "what it shows":'))
            continue
        last = heads[at + 1] if at + 1 < len(heads) else len(text.lines)
        yield _Block(words[1][1:], span, tuple(text.lines[number + 1 : last]))


def _problem(code: str, span: Span, reason: str, example: str) -> Diagnostic:
    return diagnostic(code, span, reason=reason, example=example)


class _TestFileReader:
    """A reader of one test: first its mission, whose words its other lines use."""

    def __init__(self, text: Words, block: _Block, vocabulary: Lexicon, given: Given) -> None:
        self._text, self._block, self._source, self._given = text, block, text.source, given
        self._problems: list[Diagnostic] = []
        self._statements = list(statements_of(text, block.lines, vocabulary, self._problems))
        self._robot = ""
        self._robot_words: list[str] = []
        self._body: Body | None = None
        self._world: str | None = None

    def test(self) -> MissionTest:
        """Raise MissionError."""
        runs = [one for one in self._statements if one.kind == "run"]
        if len(runs) != 1:
            span = runs[1].span if runs else self._block.span
            reason = "it runs more than one mission" if runs else "it runs no mission"
            self._problems.append(_problem("BT181", span, reason, 'run "patrol.txt"'))
            raise MissionError(self._problems)
        try:
            mission = self._mission(runs[0])
            if mission.robot and not self._robot:
                self._choose_robot(mission.robot)
            if rules := self._find_file("rules"):
                mission = read_house_rules(self._parse(read_source(rules, _root(self._source)))).around(mission)
        except MissionError as error:  # the other lines need its words
            moved_problems = [move_problem(problem, self._source) for problem in error.diagnostics]
            raise MissionError([*self._problems, *moved_problems]) from None
        keywords = list(self._robot_words)
        if mission.syntax is not None:
            needed = [path for role, path in mission.syntax.needs if role == NEEDED_WORDS]
            keywords += [included_path(path, mission.syntax.span.source)[0] for path in needed]
        gauges = gauge_words(self._body, world_vocabulary(keywords, mission.world))
        vocabulary = world_vocabulary([*keywords, WORDS, *gauges], mission.world)
        pieces = MissionEnglish(self._text, vocabulary, mission)
        at_run = self._statements.index(runs[0])
        for number, one in enumerate(self._statements):
            try:
                pieces.add(one, before=number < at_run)
            except MissionError as error:
                self._problems += error.diagnostics
        if self._problems:
            raise MissionError(self._problems)
        return MissionTest(
            self._block.name, self._block.span, mission, vocabulary, tuple(pieces.setup), tuple(pieces.fakes),
            tuple(pieces.steps), tuple(pieces.texts), *pieces.limit(runs[0]), self._robot,
        )  # fmt: skip

    def _choose_robot(self, file: str) -> None:
        self._robot, self._body = file, body_of(file)
        self._robot_words = words_of(self._body)

    def _mission(self, run: ScriptStatement) -> Mission:
        world = self._find_file("world") or None
        self._robot = self._find_file("robot")
        if self._robot:
            self._choose_robot(self._robot)
            world = world or self._body.world or None
        self._world = world
        if run.file is not None:
            mission = self._given(_name(run.file), world)
            if mission is not None:
                return mission
            return self._parse(read_source(self._path(run.file), _root(self._source)))
        if run.block is None:
            raise MissionError([_problem("BT181", run.span, "it runs no mission", 'run "patrol.txt"')])
        return self._parse(_only(self._source, run.block))

    def _parse(self, source: Source) -> Mission:
        """Parse a mission in the words of the robot and the names of the world of the test. Raises MissionError."""
        return parse_tree(source, keywords=self._robot_words, world=self._world, has_robot=bool(self._robot))

    def _find_file(self, kind: str) -> str:
        """Return the path that the first statement of a kind names; "" where none does."""
        return next((self._path(one.file) for one in self._statements if one.kind == kind), "")

    def _path(self, named: Span | None) -> str:
        """Return where a file lies that the test names. Raises MissionError where that is no folder of the user's."""
        assert named is not None
        path, real = included_path(_name(named), self._source)
        if not is_within(real, self._source, ""):
            raise MissionError([diagnostic("BT001", named, file=path, reason=OUTSIDE)])
        if not os.path.isfile(real):
            raise MissionError([diagnostic("BT001", named, file=path, reason="there is no such file")])
        return path


def _name(file: Span) -> str:
    return file.text.strip("\"'“”„’‘")  # noqa: RUF001


def _root(source: Source) -> str | None:
    return source.roots[1] if len(source.roots) > 1 else None


def _only(source: Source, span: Span) -> Source:
    """Return a text in which all but a part is blank, so that places in it are the same."""
    before = "".join(character if character == "\n" else " " for character in source.text[: span.start])
    return Source(before + span.text, source.name, source.folder, source.roots, may_load=source.may_load)
