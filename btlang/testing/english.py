"""The parts of the lines of a test that are English of missions: conditions, and what happens in the world."""

from __future__ import annotations

from btlang.api import Mission
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.frontends.mission.reader import lexed, read_mission
from btlang.passes import compile_mission
from btlang.testing.statements import ScriptStatement
from btlang.testing.test import (
    ALWAYS,
    BEFORE,
    EVENT,
    FINALLY,
    FOR,
    HOLDS,
    NEVER,
    USUAL_LIMIT,
    WITHIN,
    Fake,
    ScriptStep,
    find_command,
)
from btlang.text.source import Source, Span
from btlang.text.words import Words
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.trie import longest

_BEFORE_RUN = ("world", "robot", "rules", "with")
_ANYWHERE = ("run", "fake")
_KINDS = {"always": ALWAYS, "never": NEVER, "finally": FINALLY, "within": WITHIN, "for": FOR}
_TOPIC = "testing"
_OF_COMMANDS = frozenset((
    "HasDone", "HasDoneOnce", "HasDoneTimes", "HasTried", "HasTriedOnce", "HasTriedTimes", "HasNeverTried",
    "HasFailedTo", "IsDoing",
))  # fmt: skip
"""The conditions of tests whose text is a command of the mission."""


class MissionEnglish:
    """A reader of what the statements of one test say, in the words of tests and of its mission."""

    def __init__(self, text: Words, vocabulary: Lexicon, mission: Mission) -> None:
        self._text, self._mission = text, mission
        self._vocabulary = vocabulary.with_places(tuple(fact.name for fact in mission.facts))
        self._known = (
            {} if mission.syntax is None else lexed(mission.syntax.span.source, mission.vocabulary).names.known
        )
        self.setup: list[Tree] = []
        self.fakes: list[Fake] = []
        self.steps: list[ScriptStep] = []
        self.texts: list[str] = []
        """The commands of the mission that conditions ask for."""

    def limit(self, run: ScriptStatement) -> tuple[float, bool]:
        """Return how long the test may take, and whether it is cut then."""
        return (USUAL_LIMIT, True) if run.seconds is None else (run.seconds, run.at_most)

    def add(self, one: ScriptStatement, *, before: bool) -> None:
        """Read one more statement, which stands before that which runs the mission or not. Raises MissionError."""
        if one.kind not in _ANYWHERE and before != (one.kind in _BEFORE_RUN):
            reason = "this line must stand behind 'run'" if before else "this line must stand before 'run'"
            raise MissionError([diagnostic("BT181", one.span, reason=reason, example='run "patrol.txt"')])
        if one.kind == "fake":
            self.fakes += self._fakes(one)
        elif one.kind == "with":
            self.setup.append(self._event(one.first, one.last))
        elif one.kind not in ("run", *_BEFORE_RUN):
            self.steps.append(self._step(one))

    def _step(self, one: ScriptStatement) -> ScriptStep:
        seconds = one.seconds or 0.0
        if one.kind == "before":
            other = self._condition(one.head, one.first - 1)
            return ScriptStep(BEFORE, one.span, self._condition(one.first, one.last), other=other)
        if one.kind == "when":
            condition = self._condition(one.head, one.first - 1)
            return ScriptStep(EVENT, one.span, condition, event=self._event(one.first, one.last))
        if one.kind in _KINDS:
            condition = self._condition(one.first, one.last, is_denied=one.kind == "never")
            return ScriptStep(_KINDS[one.kind], one.span, condition, seconds)
        match = longest(self._vocabulary.trie, self._text, one.first, self._vocabulary.context)
        if match is not None and match.meaning.role == "command":
            return ScriptStep(EVENT, one.span, None, seconds, event=self._event(one.first, one.last))
        return ScriptStep(HOLDS, one.span, self._condition(one.first, one.last), seconds)

    def _condition(self, first: int, last: int, *, is_denied: bool = False) -> Tree:
        """Return a condition in these words, or its negation. Raises MissionError."""
        check, no = self._vocabulary.word("check"), self._vocabulary.word("not")
        tree = self._read(first, last, f"{check} {no} (" if is_denied else f"{check} ", ")" * is_denied)
        for node in tree.walk():
            if node.id in _OF_COMMANDS:
                self._ask(node, first, last)
        return tree

    def _ask(self, node: Node, first: int, last: int) -> None:
        text = node.port("text")
        if find_command(text, self._mission) is None:
            raise self._no_command(text, self._text.span(first, last))
        self.texts.append(text)

    def _event(self, first: int, last: int) -> Tree:
        """Return what happens in the world. Raises MissionError, also for a command to the robot (BT182)."""
        tree = self._read(first, last)
        for node in tree.walk():
            entry = self._vocabulary.entry(node.id)
            if not node.children and (entry is None or entry.topic != _TOPIC):
                span = node.span or self._text.span(first, last)
                reason = "is for the robot; a test changes only the world around it"
                raise MissionError(
                    [move_problem(diagnostic("BT182", span, words=span.text, reason=reason), self._text.source)]
                )
        return tree

    def _read(self, first: int, last: int, opener: str = "", end: str = "") -> Tree:
        """Return the tree of a part of the text as a mission of its own, in which places are the same."""
        if first >= last:
            span = self._text.span(first - 1, first)
            raise MissionError([diagnostic("BT180", span, words=span.text, wanted="finally the mission succeeds")])
        part, whole = self._text.span(first, last), self._text.source
        blank = "".join("\n" if character == "\n" else " " for character in whole.text[: part.start])
        text = blank[: part.start - len(opener)] + opener + part.text + end
        source = Source(text, whole.name, whole.folder, ())
        try:
            read = read_mission(source, self._vocabulary, known=self._known)
            return compile_mission(read.mission, self._vocabulary)
        except MissionError as error:
            raise MissionError([move_problem(problem, whole, part) for problem in error.diagnostics]) from None

    def _fakes(self, one: ScriptStatement) -> list[Fake]:
        """Read `"grasp" fails twice, then succeeds`: each part stands in for the command after the one before it."""
        words = self._text.words[one.first : one.last]
        name = words[0][1:]
        command = find_command(name, self._mission)
        if command is None:
            raise self._no_command(name, self._text.span(one.first, one.first + 1))
        if SUBTREE in command.ids:
            span, reason = self._text.span(one.first, one.first + 1), "is a definition; fake the commands in it"
            raise MissionError([diagnostic("BT182", span, words=name, reason=reason)])
        found: list[Fake] = []
        at = one.first + 1
        while at < one.last:
            succeeds, seconds, at = self._outcome(one, at)
            times, at = self._times(one, at)
            found.append(Fake(name, command, succeeds != command.is_denied, seconds, times))
            while at < one.last and self._text.words[at] in (",", "then", "and"):
                at += 1
        if not found or any(not fake.times for fake in found[:-1]):
            raise self._unread_fake(one)
        return found

    def _outcome(self, one: ScriptStatement, at: int) -> tuple[bool, float, int]:
        word, following = self._text.words[at], self._text.words[at + 1]
        if word == "is" and following in ("true", "false"):
            return following == "true", 0.0, at + 2
        if word not in ("fails", "succeeds", "takes"):
            raise self._unread_fake(one)
        behind = at + 1 + (following == "after" and word != "takes")
        found = self._vocabulary.values.quantity(self._text, behind, ("duration",))
        if behind == at + 2 or word == "takes":
            if found is None or found[1] != "duration":
                raise self._unread_fake(one)
            return word != "fails", found[0], found[2]
        return word == "succeeds", 0.0, at + 1

    def _times(self, one: ScriptStatement, at: int) -> tuple[int, int]:
        word = self._text.words[at]
        if at >= one.last or word in (",", "then", "and"):
            return 0, at
        if word in ("once", "twice", "always"):
            return {"once": 1, "twice": 2, "always": 0}[word], at + 1
        number = self._vocabulary.values.number(self._text, at)
        if number is None or number[0] < 1 or number[0] % 1 or self._text.words[number[1]] not in ("times", "time"):
            raise self._unread_fake(one)
        return int(number[0]), number[1] + 1

    def _unread_fake(self, one: ScriptStatement) -> MissionError:
        return MissionError(
            [diagnostic("BT180", one.span, words=one.span.text, wanted='"grasp the cup" fails twice, then succeeds')]
        )

    def _no_command(self, words: str, span: Span) -> MissionError:
        reason = "isn't a command, condition or definition of the mission"
        return MissionError([diagnostic("BT182", span, words=words, reason=reason)])


def move_problem(problem: Diagnostic, source: Source, part: Span | None = None) -> Diagnostic:
    """Return a problem with a part of a text that was read by itself, with its places in the whole text."""

    def place(span: Span) -> Span:
        if span.source.name != source.name:
            return span
        start = span.start if part is None else min(max(span.start, part.start), part.end)
        return Span(source, start, max(start, span.end if part is None else min(span.end, part.end)))

    return problem.replace(  # type: ignore[no-any-return]
        span=place(problem.span),
        notes=tuple((place(span), text) for span, text in problem.notes),
        fix=problem.fix and (place(problem.fix[0]), problem.fix[1]),
        readings=tuple((place(span), text) for span, text in problem.readings),
    )
