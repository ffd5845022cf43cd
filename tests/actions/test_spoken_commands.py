"""Commands that people speak, and conditions about what somebody says."""

from __future__ import annotations

import pytest

import btlang
from btlang.actions.conversation import answer_is, answer_number, ask, meaning_of
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.robot import RobotError
from btlang.robots.spoken_commands import SpokenCommands, choices
from btlang.run.bus import INLINE
from btlang.run.events import Event, Said
from btlang.run.world_input import WorldInput
from btlang.session import Run
from btlang.speech.recogniser import Grammar

OBEY = btlang.parse_tree("obey what somebody says")


def run(mission: btlang.Mission, *answers: str) -> Run:
    with btlang.Session() as session:
        return session.run(mission, speed="max", sinks=[WorldInput({"*": list(answers)})])


def said(run: Run) -> list[str]:
    return [event.text for event in run.events() if event.tag == "say"]


def ways(run: Run) -> list[str]:
    return [event.name for event in run.events() if event.tag == "navigate"]


def test_a_command_is_said_back_and_done_after_a_yes() -> None:
    done = run(OBEY, "go to the kitchen", "yes, please")
    assert done.outcome is not None
    assert done.outcome.succeeded, done.outcome.why()
    assert (said(done), ways(done)) == (["Shall I go to the kitchen?"], ["kitchen"])


def test_nothing_moves_after_a_no() -> None:
    done = run(OBEY, "go to the kitchen", "no")
    assert done.outcome is not None
    assert not done.outcome.succeeded
    assert (said(done), ways(done)) == (["Shall I go to the kitchen?"], [])


COMMANDS = SpokenCommands(OBEY.vocabulary, btlang.Session().robot.body)


@pytest.mark.parametrize(
    "text",
    [
        "open the staff zone", "go to the kitchen then go to the lab", "repeat forever: turn left", "say hello",
        "go to the moon", "obey what somebody says", "raise your right arm", "clear the map", "ask Alice \"Hm?\"", "",
        "<root/>", "{}", "if bumped, stop", "open the lab door", "do \"GoTo\" with place \"kitchen\"; turn left",
    ],
)  # fmt: skip
def test_what_may_not_be_commanded(text: str) -> None:
    with pytest.raises(RobotError):
        COMMANDS.read(text)


def test_all_that_is_listened_for_can_be_done() -> None:
    with btlang.Session() as session:
        grammar = Grammar(COMMANDS.expected(session.robot))
        for text in ("go to the kitchen", "turn around", "stop", "turn left", "follow Alice"):
            assert grammar.holds(text), text
            COMMANDS.read(text)
        for text in ("say hello", "raise your right arm", "open the lab door"):
            assert not grammar.holds(text), text


def test_the_choices_of_a_mission() -> None:
    mission = btlang.parse_tree('ask "Tea?"\nif the answer is tea, say hi\nif the answer is "hot milk", say ho')
    assert choices(mission.tree, mission.vocabulary) == ("tea", "hot milk")


class Greetings:
    policy = INLINE

    def __init__(self, said: list[str]) -> None:
        self._said = said

    def __call__(self, event: Event) -> None:
        if isinstance(event, Said):
            self._said.append(event.text)


def test_a_rule_hears_what_is_said_since_it_looked_last() -> None:
    mission = btlang.parse_tree('whenever somebody says hello: say "Good day"\nwait 3 s, then wait 3 s')
    greeted: list[str] = []
    with btlang.Session() as session:
        session.robot.hear("hello", "Alice")  # before anybody looked
        prepared = session.prepare(mission, speed="max", sinks=[Greetings(greeted)])
        for at in range(150):
            if at in (20, 90):
                session.robot.hear("Well, hello robot!", "Alice")
            prepared.tick()
    assert greeted == ["Good day", "Good day"]


def test_a_rule_hears_that_somebody_speaks_whatever_they_say() -> None:
    mission = btlang.parse_tree('whenever Alice speaks: say "Yes?"\nwait 3 s, then wait 3 s')
    greeted: list[str] = []
    with btlang.Session() as session:
        prepared = session.prepare(mission, speed="max", sinks=[Greetings(greeted)])
        for at in range(150):
            if at in (20, 60, 90):
                session.robot.hear("nice weather", "Bob" if at == 60 else "Alice")
            prepared.tick()
    assert greeted == ["Yes?", "Yes?"]


@pytest.mark.parametrize(
    ("answer", "holds"), [("8", True), ("it is about seven", True), ("6.5 or so", False), ("twenty-five", True)]
)
def test_the_number_in_an_answer_is_compared(answer: str, holds: bool) -> None:
    with btlang.Session() as session:
        session.robot.ears.answer = answer
        assert bool(answer_number(session.robot, at_least=7)) is holds


def test_an_answer_without_a_number_compares_with_none() -> None:
    with btlang.Session() as session:
        session.robot.ears.answer = "a lot"
        with pytest.raises(ActionFailed, match="no number"):
            answer_number(session.robot, above=7)


def test_an_answer_is_none_to_a_question_that_could_not_be_asked() -> None:
    with btlang.Session() as session:
        session.robot.ears.answer = "yes"  # to an earlier question
        with pytest.raises(RobotError):
            next(ask(session.robot, "Stay?", "Zoe"))
        assert not answer_is(session.robot, "yes")


@pytest.mark.parametrize(
    ("text", "meaning"),
    [("I do", "yes"), ("I do not want that", "no"), ("Of course not!", "no"), ("why not", "yes"), ("tea", "tea")],
)
def test_the_longest_words_of_an_answer_say_what_it_means(text: str, meaning: str) -> None:
    assert meaning_of(text) == meaning
