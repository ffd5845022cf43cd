"""Words whose slots are declared by the annotations of their functions."""

from __future__ import annotations

from typing import Annotated, Any

import pytest

import btlang
from btlang import Length, Person

DONE: list[object] = []


@btlang.action("cheer for {name} [{times} times]")
def cheer(name: Person, times: int = 1) -> None:
    DONE.append((name, times))


@btlang.action()
def creep_by(distance: Length, clock: Any) -> None:
    DONE.append(distance)


@btlang.action("aim at {mark} with {share}")
def aim(mark: Annotated[str, "object"], share: float) -> None:
    DONE.append((mark, share))


@btlang.action("paint it {color}")
def paint(color: str) -> None:
    DONE.append(color)


@btlang.action()
class HumOn:
    def start(self, words: str) -> None:
        DONE.append(words)

    def tick(self) -> bool:
        return True

    def halt(self) -> None:
        """Nothing moves."""


def test_types_units_and_defaults() -> None:
    DONE.clear()
    text = 'cheer for Alice 2 times, cheer for Bob, creep by 50 cm, aim at the cup with 0.5, paint it red, hum on "la"'
    assert btlang.parse_tree(text, keywords=[cheer, creep_by, aim, paint, HumOn]).run(speed="max").succeeded
    assert DONE == [("Alice", 2), ("Bob", 1), 0.5, ("cup", 0.5), "red", "la"]
    with pytest.raises(btlang.MissionError):
        btlang.parse_tree("cheer for the table", keywords=[cheer])


def test_a_parameter_that_says_int_gets_an_int() -> None:
    got: list[object] = []

    @btlang.action("weld part {number} to {percent} for {length}")
    def weld(number: int, percent: int, length: float) -> None:
        got.extend((number, percent, length))

    for text in ("weld part 2 to 10% for 3 m", "set n to 0 then weld part n to 10% for 3 m"):
        assert btlang.parse_tree(text, keywords=[weld]).run(speed="max").succeeded
    assert list(map(repr, got)) == ["2", "10", "3.0", "0", "10", "3.0"]
    with pytest.raises(btlang.MissionError, match=r"number cannot be '1\.5': a whole number is needed"):
        btlang.parse_tree("weld part 1.5 to 10% for 3 m", keywords=[weld]).run(speed="max")
    outcome = btlang.parse_tree("set n to 1.5 then weld part n to 10% for 3 m", keywords=[weld]).run(speed="max")
    assert "a whole number is needed" in outcome.why()


def test_errors_show_the_line_of_the_decorator() -> None:
    with pytest.raises(btlang.MissionError) as caught:

        @btlang.action("hop {n")
        def hop(n: int) -> None:
            pass

    assert caught.value.diagnostics[0].span.text == '@btlang.action("hop {n")'
    assert "test_annotations.py:" in str(caught.value)

    @btlang.action("skip {what}")
    def skip(what: object) -> None:
        pass

    with pytest.raises(btlang.MissionError, match=r"BT061.*annotate it with int, float") as caught:
        btlang.parse_tree("skip it", keywords=[skip])
    assert caught.value.diagnostics[0].span.text == '@btlang.action("skip {what}")'


@btlang.action
def spin_for(rounds: int) -> None:
    DONE.append(rounds)


@btlang.action
class Purr:
    """Purrs."""

    def start(self) -> bool:
        DONE.append("purr")
        return True

    def tick(self) -> bool:
        return True

    def halt(self) -> None:
        """Nothing moves."""


@btlang.condition
def it_is_quiet() -> bool:
    return "purr" not in DONE


def test_a_decorator_without_parentheses_takes_the_name_and_the_parameters() -> None:
    DONE.clear()
    text = "if it is quiet, spin for 3. If it is quiet, purr. If it is quiet, wave"
    mission = btlang.parse_tree(text, keywords=[spin_for, Purr, it_is_quiet])
    assert mission.run(speed="max").succeeded
    assert DONE == [3, "purr"]
    assert Purr.__doc__ == "Purrs."


def test_errors_below_a_bare_decorator_show_its_line() -> None:
    @btlang.action
    def skip(what: object) -> None:
        pass

    with pytest.raises(btlang.MissionError, match="BT061") as caught:
        btlang.parse_tree("skip it", keywords=[skip])
    assert caught.value.diagnostics[0].span.text == "@btlang.action"


def test_a_quantity_of_no_known_type_is_one_mistake() -> None:
    @btlang.quantity("load", type="weight")
    def load() -> float:
        return 1.0

    with pytest.raises(btlang.MissionError) as raised:
        btlang.parse_tree("say the load", keywords=[load])
    [problem] = raised.value.diagnostics
    assert "what it measures has no type 'weight'; [[type]] declares one, known are " in problem.message
