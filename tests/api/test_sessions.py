"""What sessions take, and how runs are ticked, awaited and shown."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.run.events import Ended, Said
from btlang.tree.node import Node
from btlang.vocabulary.shipped import STANDARD_BODY


@btlang.action("stumble")
def stumble() -> None:
    raise ZeroDivisionError("over a stone")


def test_a_session_takes_texts_paths_missions_and_trees(tmp_path: Path) -> None:
    path = tmp_path / "mission.txt"
    path.write_text("say hello", encoding="utf-8")
    node = Node("Say", ports=(("text", "hello"),))
    xml = btlang.parse_tree("say hello").to("xml")
    assert isinstance(xml, str)
    for given in ("say hello", path, btlang.parse_tree("say hello"), btlang.parse_tree("say hello").tree, node, xml):
        said: list[Any] = []
        with btlang.Session() as session:
            run = session.run(given, speed="max", sinks=[said.append])
        assert run.outcome is not None
        assert run.outcome.succeeded
        assert [event.text for event in said if isinstance(event, Said)] == ["hello"]


def test_a_text_is_read_with_the_words_and_the_world_of_the_session(tmp_path: Path) -> None:
    world = tmp_path / "world.toml"
    world.write_text('start = { x = 1, y = 1 }\nplaces = [{ name = "bay", x = 2, y = 2 }]\n', encoding="utf-8")
    with btlang.Session(world=world, keywords=[stumble]) as session:
        assert session.run("go to the bay", speed="max").outcome.succeeded  # type: ignore[union-attr]
        assert not session.run("stumble", speed="max").outcome.succeeded  # type: ignore[union-attr]
        with pytest.raises(btlang.MissionError):
            session.run("go to the lab")


_ROOM = 'start = {{ x = 1, y = 1 }}\nplaces = [{{ name = "{}", x = 2, y = 2 }}]\n'


def test_a_session_is_in_the_world_of_its_robot_file(tmp_path: Path) -> None:
    (tmp_path / "room.toml").write_text(_ROOM.format("bay"), encoding="utf-8")
    robot = tmp_path / "robot.toml"
    robot.write_text(f"{Path(STANDARD_BODY).read_text('utf-8')}\n", encoding="utf-8")
    robot.write_text(f'world = "room.toml"\n{robot.read_text("utf-8")}', encoding="utf-8")
    with btlang.Session(robot) as session:
        assert session.run("go to the bay", speed="max").outcome.succeeded  # type: ignore[union-attr]
        with pytest.raises(btlang.MissionError, match="lab"):
            session.run("go to the lab")


def test_a_session_is_in_the_world_of_its_first_mission(tmp_path: Path) -> None:
    for name in ("bay", "pier"):
        (tmp_path / f"{name}.toml").write_text(_ROOM.format(name), encoding="utf-8")
        (tmp_path / f"{name}.txt").write_text(f'world "{name}.toml"\ngo to the {name}\n', encoding="utf-8")
    for given in (tmp_path / "bay.txt", btlang.parse_file(tmp_path / "bay.txt")):
        with btlang.Session() as session:
            assert session.run(given, speed="max").outcome.succeeded  # type: ignore[union-attr]
            assert [place.name for place in session.world.places] == ["bay"]
            with pytest.raises(btlang.MissionError, match="pier"):  # the robot is in the other world
                session.run(tmp_path / "pier.txt")
    with btlang.Session() as session:
        assert session.robot is not None  # who has used the robot keeps its world
        with pytest.raises(btlang.MissionError, match="bay"):
            session.run(tmp_path / "bay.txt")


def test_a_str_is_never_a_path(tmp_path: Path) -> None:
    path = tmp_path / "mission.txt"
    path.write_text("say hello", encoding="utf-8")
    with btlang.Session() as session, pytest.raises(btlang.MissionError):
        session.run(str(path))


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: btlang.Session().run(3), "a mission is a text, a path .* not an int"),
        (lambda: btlang.Session().run(None), "not None"),
        (lambda: btlang.Session(3), "robot is a name"),
        (lambda: btlang.parse_tree(Path("x.txt")), "parse_file reads a file"),
        (lambda: btlang.parse_tree("wave", keywords="words.toml"), "keywords is a list"),
        (lambda: btlang.parse_tree("wave", keywords=[3]), "decorate it"),
        (lambda: btlang.parse_tree("wave", world=3), "world is the path"),
        (lambda: btlang.parse_tree("wave").run(time_limit="3"), "time_limit is a number"),
        (lambda: btlang.parse_tree("wave").run(rate="3"), "rate is a number"),
    ],
)
def test_what_is_of_the_wrong_type_says_what_is_taken(call: Any, said: str) -> None:
    with pytest.raises(TypeError, match=said):
        call()


def test_mission_time_passes_as_the_caller_says() -> None:
    with btlang.Session() as session:
        run = session.prepare("wait 1 s")
        statuses = []
        while run.outcome is None:
            statuses.append(run.tick(0.25))
        assert statuses == [*[btlang.Status.RUNNING] * 4, btlang.Status.SUCCESS]
        assert run.seconds == pytest.approx(1.0)
        assert str(run.outcome) == "The mission succeeded in 1.0 s."
        assert run.tick(0.25) is btlang.Status.RUNNING
        assert run.outcome is None
        with pytest.raises(ValueError, match="positive"):
            run.tick(0)


def test_events_of_own_ticks_end_with_the_tree() -> None:
    async def stream(run: btlang.Run) -> list[Any]:
        return [event async for event in run]

    async def main(run: btlang.Run) -> tuple[list[Any], btlang.Outcome]:
        run.tick(0.5)
        reading = asyncio.create_task(stream(run))
        await asyncio.sleep(0)
        while run.tick(0.5) is btlang.Status.RUNNING:
            await asyncio.sleep(0)
        return await reading, await run

    said: list[str] = []

    @btlang.action("count one")
    def count_one() -> None:
        said.append("one")

    with btlang.Session(keywords=[count_one]) as session:
        run = session.prepare("count one then wait 1 s")
        events, outcome = asyncio.run(main(run))
        assert (outcome.succeeded, said) == (True, ["one"])
        assert list(run.events()) == events != []
        run.tick(0.5)
        run.halt()
        assert len(list(run.events())) > len(events)


def test_events_and_the_outcome_in_asyncio() -> None:
    async def main() -> tuple[list[Any], btlang.Outcome, int]:
        beats = 0

        async def beat() -> None:
            nonlocal beats
            while True:
                beats += 1
                await asyncio.sleep(0)

        with btlang.Session() as session:
            other = asyncio.create_task(beat())
            run = session.prepare("say hello then wait 0.2 s", speed=4)
            events = [event async for event in run]
            outcome = await run
            other.cancel()
            assert [event async for event in run] == events
        return events, outcome, beats

    events, outcome, beats = asyncio.run(main())
    assert outcome.succeeded
    assert isinstance(events[-1], Ended)
    assert any(isinstance(event, Said) for event in events)
    assert beats > 3, "the loop was blocked"


def test_awaiting_a_run_raises_what_ended_it() -> None:
    async def main() -> None:
        with btlang.Session() as session:
            run = session.prepare("wave", speed="max")
            run.after_ticks(lambda: 1 / 0)
            await run

    with pytest.raises(ZeroDivisionError):
        asyncio.run(main())


def test_each_repr_is_short() -> None:
    mission = btlang.parse_tree("say hello then stumble or nod", keywords=[stumble])
    assert repr(mission) == "<Mission 'say hello then stumble or nod', 5 nodes, 1 warning>"
    with btlang.Session() as session:
        assert repr(session) == "<Session on SimulatedRobot>"
        run = session.prepare(mission, speed="max")
        assert repr(run) == f"<Run {run.id[:8]}, not started, 0.0 s>"
        assert not run.succeeded
        outcome = run.execute()
        assert run.succeeded
        assert repr(run) == f"<Run {run.id[:8]}, ended: SUCCESS after {outcome.seconds:.1f} s>"
    events = [repr(event) for event in run.events()]
    assert events[0] == "<StatusesChanged 0.00 s, Say RUNNING>"
    assert events[1] == '<Said 0.00 s, says "hello">'
    assert events[-1].startswith("<Ended ")
    assert "outcome='SUCCESS', seconds=" in events[-1]
    assert max(map(len, events)) < 130
    assert repr(outcome) == f"<Outcome SUCCESS after {outcome.seconds:.1f} s, 1 exception caught>"
    assert [repr(error) for error in outcome.exceptions] == ["ZeroDivisionError('over a stone')"]
    with pytest.raises(btlang.MissionError) as caught:
        btlang.parse_tree("fly")
    assert repr(caught.value) == "<MissionError BT010>"
    assert repr(caught.value.diagnostics[0]).startswith("<Diagnostic BT010 at <text>:1:1: ")


def test_an_outcome_is_printed_as_the_command_line_does() -> None:
    outcome = btlang.parse_tree("stumble", keywords=[stumble]).run(speed="max")
    assert str(outcome) == outcome.why()
    assert repr(outcome) == "<Outcome FAILURE after 0.0 s: ZeroDivisionError: over a stone>"
    assert len(outcome.exceptions) == 1
    stopped = btlang.parse_tree("wait 9 s").run(speed="max", time_limit=1)
    assert str(stopped) == "Stopped after 1.0 s, as asked; the robot stands still."
    assert repr(stopped) == "<Outcome time limit after 1.0 s>"


def test_the_words_of_the_robot_are_known_to_its_session() -> None:
    with btlang.Session(Path(__file__).parents[2] / "examples" / "guide" / "robot.toml") as session:
        assert session.run("applaud", speed="max").outcome.succeeded  # type: ignore[union-attr]
    with pytest.raises(btlang.MissionError, match="BT010"), btlang.Session() as session:
        session.run("applaud", speed="max")


def test_a_session_has_one_run_at_a_time_also_where_runs_are_ticked() -> None:
    with btlang.Session() as session:
        earlier, run = session.prepare("wave"), session.prepare("wave")
        for begin in (earlier.tick, earlier.execute, earlier.start):
            with pytest.raises(RuntimeError, match="prepared another run"):
                begin()
        assert run.tick() is btlang.Status.RUNNING
        assert session.restore("wave", run.save()).tick() is btlang.Status.RUNNING
        with pytest.raises(RuntimeError, match="prepared another run"):
            run.tick()


def test_a_status_is_printed_by_its_name_and_equals_its_number() -> None:
    assert f"{btlang.Status.RUNNING} {btlang.Status.SUCCESS!s}" == "RUNNING SUCCESS"
    assert btlang.Status.RUNNING == 2
