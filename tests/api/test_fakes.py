"""Words that replace known ones, and the time of what works beside the tick at full speed."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, ClassVar

import pytest

import btlang


def test_a_fake_runs_in_place_of_the_word_with_its_phrase() -> None:
    went: list[str] = []

    @btlang.action("go to {place}", replace=True)
    def fake(place: str) -> None:
        went.append(place)

    mission = btlang.parse_tree("go to the lobby then drive to the lab", keywords=[fake])
    assert [node.id for node in mission.tree.root.children] == ["GoTo", "GoTo"]
    outcome = mission.run(speed="max")
    assert (outcome.succeeded, went, outcome.seconds < 0.2) == (True, ["lobby", "lab"], True)


def test_a_fake_by_its_id_may_have_other_words() -> None:
    said: list[str] = []

    @btlang.action("whisper {text}", id="Say", replace=True)
    def fake(text: str) -> None:
        said.append(text)

    assert btlang.parse_tree("say hello then whisper bye", keywords=[fake]).run(speed="max").succeeded
    assert said == ["hello", "bye"]


def test_a_fake_quantity() -> None:
    @btlang.quantity("battery", type="percent", replace=True)
    def fake() -> float:
        return 12.0

    outcome = btlang.parse_tree("check the battery is below 20%", keywords=[fake]).run(speed="max")
    assert outcome.status is btlang.Status.SUCCESS


def test_without_replace_the_clash_is_an_error() -> None:
    @btlang.action("go to {place}", id="GoTo")
    def fake(place: str) -> None: ...

    with pytest.raises(btlang.MissionError, match=r"BT064(.|\n)*replace=True"):
        btlang.parse_tree("go to the lobby", keywords=[fake])


def test_there_must_be_something_to_replace() -> None:
    @btlang.action("fly to {place}", replace=True)
    def fake(place: str) -> None: ...

    with pytest.raises(btlang.MissionError, match="nothing to replace"):
        btlang.parse_tree("fly to the lobby", keywords=[fake])


def test_a_pack_replaces(tmp_path: Path) -> None:
    (tmp_path / "fakes.py").write_text("def wave(robot):\n    robot.print('faked')\n")
    pack = tmp_path / "fakes.toml"
    entry = '[[action]]\nphrase = "wave like a fake"\nid = "Wave"\ncall = "fakes:wave"\n'
    pack.write_text(f'replaces = ["Wave"]\n{entry}')
    printed: list[str] = []
    mission = btlang.parse_tree("wave", keywords=[str(pack)])
    assert mission.run(speed="max", sinks=[lambda e: printed.append(getattr(e, "text", ""))]).succeeded
    assert "faked" in printed
    pack.write_text(f'replaces = ["Nod"]\n{entry}')
    with pytest.raises(btlang.MissionError, match="no entry of this file has the id 'Nod'"):
        btlang.parse_tree("wave", keywords=[str(pack)])
    pack.write_text(entry)
    with pytest.raises(btlang.MissionError, match=r"BT064(.|\n)*replaces = \[\"Wave\"\]"):
        btlang.parse_tree("wave", keywords=[str(pack)])


def test_a_wrong_ros_table_is_refused_where_it_is_written() -> None:
    with pytest.raises(ValueError, match="publish"):
        btlang.action("beep", ros={"publish": 5})(lambda: None)


async def nap() -> None:
    await asyncio.sleep(0.5)


def doze() -> None:
    time.sleep(0.5)


@pytest.mark.parametrize(("call", "thread"), [(nap, False), (doze, True)])
def test_full_speed_waits_for_what_works_beside_the_tick(call: Callable[[], Any], thread: bool) -> None:
    rest = btlang.action("rest a bit", thread=thread)(call)
    text = "wait 100 s then rest a bit within 10 s then wait 100 s"
    began = time.monotonic()
    outcome = btlang.parse_tree(text, keywords=[rest]).run(speed="max")
    assert outcome.succeeded, outcome.why()
    assert 200.4 < outcome.seconds < 230
    assert time.monotonic() - began < 60


def test_what_never_ends_is_still_ended_by_its_time_limit() -> None:
    async def forever() -> None:
        await asyncio.sleep(1000)

    rest = btlang.action("rest for good")(forever)
    outcome = btlang.parse_tree("rest for good within 0.3 s", keywords=[rest]).run(speed="max")
    assert outcome.status is btlang.Status.FAILURE
    assert 0.3 <= outcome.seconds < 3


def test_dir_lists_what_there_is() -> None:
    assert {"Mission", "Session", "parse_tree", "parse_file", "quantity", "Status"} <= set(dir(btlang))
    assert all(getattr(btlang, name) is not None for name in dir(btlang))


def test_parse_file(tmp_path: Path) -> None:
    (tmp_path / "part.txt").write_text("bow is nod\n")
    (tmp_path / "mission.txt").write_text('include "part.txt"\nbow\n')
    assert btlang.parse_file(str(tmp_path / "mission.txt")).run(speed="max").succeeded
    with pytest.raises(btlang.MissionError, match="BT001"):
        btlang.parse_file(str(tmp_path / "none.txt"))


def test_a_fake_runs_in_place_of_a_function_of_a_tree() -> None:
    rung: list[tuple[str, int]] = []

    @btlang.condition("the gate is open")
    def gate_is_open() -> bool:
        return True

    @btlang.action("ring the bell {n} times")
    def ring_bell(n: int) -> None:
        rung.append(("real", n))

    @btlang.condition("the gate is open", replace=True)
    def closed() -> bool:
        return False

    @btlang.action(id="RingBell", replace=True)
    def fake(n: int) -> None:
        rung.append(("fake", n))

    tree = btlang.sequence(gate_is_open, btlang.leaf(ring_bell, 3), "nod")
    assert not tree.run(speed="max", keywords=[closed]).succeeded
    assert tree.mission(keywords=[fake]).run(speed="max").succeeded
    assert tree.run(speed="max").succeeded
    assert rung == [("fake", 3), ("real", 3)]


@btlang.action("count down from {number}")
class CountDown:
    """A leaf with the words of one that ships."""

    counted: ClassVar[list[int]] = []

    def start(self, number: int) -> None:
        self.counted.append(number)

    def tick(self) -> bool:
        return True

    def halt(self) -> None: ...


@btlang.action
class DoThing(CountDown):
    """A class whose words are those of its name."""


def test_own_words_go_before_those_that_ship_and_keep_their_capitals() -> None:
    tree = btlang.sequence("count down from 2", "do thing 3")
    assert [node.id for node in tree.mission().tree.root.children] == ["CountDown", "DoThing"]
    assert tree.run(speed="max").succeeded
    assert CountDown.counted == [2, 3]


@btlang.quantity("pressure of the tank", type="number")
def pressure() -> float:
    return 5.0


@btlang.action("warm the sample for {number} rounds")
def warm(number: float, kept: dict[str, Any]) -> Iterator[None]:
    yield


def test_fakes_of_words_in_texts_leave_the_other_words_of_the_script() -> None:
    @btlang.quantity("pressure of the tank", type="number", replace=True)
    def low() -> float:
        return 1.0

    @btlang.action(id="DoThing", replace=True)
    def fake(number: int) -> None: ...

    tree = btlang.sequence("check the pressure of the tank is above 3", "warm the sample for 40 rounds", "do thing 3")
    for keywords, succeeds in (([], True), ([fake], True), ([warm, pressure, fake], True), ([low], False)):
        assert tree.run(speed="max", keywords=keywords).succeeded is succeeds, keywords
