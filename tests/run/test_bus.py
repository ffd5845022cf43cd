"""Events with identity, on a bus whose sinks delay no tick; sessions, snapshots and the schema of the log."""

from __future__ import annotations

import io
import json
import threading
import time

import pytest

import btlang
from btlang.run import bus as buses
from btlang.run.bus import BLOCK, DROP_OLDEST, INLINE, NEWEST, Bus
from btlang.run.events import LOGGED, Ended, Event, Printed, Said, StatusesChanged
from btlang.run.logs import JsonLog, as_json
from btlang.run.recent import RecentEvents
from tests.generate import log_schema


class Slow:
    """A sink that takes a tenth of a second for each event, or stands still until it is let go."""

    def __init__(self, policy: str, seconds: float = 0.1) -> None:
        self.policy = policy
        self.seconds = seconds
        self.heard: list[Event] = []
        self.go_on = threading.Event()

    def __call__(self, event: Event) -> None:
        self.heard.append(event)
        self.go_on.wait(self.seconds)


@pytest.mark.parametrize("policy", [BLOCK, DROP_OLDEST, NEWEST])
def test_a_slow_sink_delays_no_tick(policy: str) -> None:
    """It had made a mission of 1 s take 2.3 s."""
    slow, ends = Slow(policy), []

    def watch(event: Event) -> None:
        if isinstance(event, Ended):
            ends.append(time.monotonic())
            slow.go_on.set()

    mission = btlang.parse_tree("wait 1 s")
    began = time.monotonic()
    outcome = mission.run(sinks=[slow, watch])
    assert outcome.succeeded
    assert outcome.overruns <= 1  # a busy machine may be late once; who waits for the sink is late at every event
    assert ends[0] - began < 1.5
    if policy == BLOCK:
        numbers = [number for event in slow.heard for number in range(event.number, event.number + event.count)]
        assert numbers == list(range(numbers[-1] + 1))
    assert slow.heard[-1].tag == "end" or policy == BLOCK


def test_who_waits_for_a_sink_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(buses, "MOST_WAITING", 2)
    bus, stuck = Bus(queued=True), Slow(BLOCK, 0.02)
    bus.add(stuck)
    for number in range(6):
        bus.emit(Said, str(number))
    bus.close()
    assert [event.text for event in stuck.heard if isinstance(event, Said)] == list("012345")
    assert bus.slow[0].sink is stuck
    assert bus.slow[0].seconds > 0.01


def test_what_is_lost_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(buses, "MOST_WAITING", 2)
    bus, stuck = Bus(queued=True), Slow(DROP_OLDEST, 10)
    bus.add(stuck)
    bus.emit(Said, "first")
    while not stuck.heard:
        time.sleep(0.001)
    for number in range(5):
        bus.emit(Said, str(number))
    stuck.go_on.set()
    bus.close()
    assert [event.text for event in stuck.heard if isinstance(event, Said)] == ["first", "3", "4"]
    assert bus.slow[0].lost == 3


def test_a_queued_sink_that_raises_is_dropped() -> None:
    problem = OSError("disk full")

    def full(event: Event) -> None:
        raise problem

    bus = Bus(queued=True)
    bus.add(full)
    for _ in range(3):
        bus.emit(Said, "x")
    bus.close()
    assert bus.errors == [problem]


def test_numbers_have_no_gaps_whoever_emits() -> None:
    bus, heard = Bus("r"), []

    def note(event: Event) -> None:
        heard.append(event.number)

    note.policy = INLINE  # type: ignore[attr-defined]
    bus.add(note)
    threads = [threading.Thread(target=lambda: [bus.emit(Printed, "x") for _ in range(200)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(heard) == list(range(800))


def test_a_session_runs_many_missions_and_late_joiners_see_the_state() -> None:
    with btlang.Session() as session:
        first = session.run(btlang.parse_tree("go to the lab"), speed="max")
        assert first.outcome is not None
        assert first.outcome.succeeded
        second = session.start(btlang.parse_tree("say hello then wait 100 s then wave"), speed=1)
        with pytest.raises(RuntimeError, match="another run is active"):
            session.run(btlang.parse_tree("wave"))
        while not (now := second.snapshot()).running or "wait" not in now.running[0]:
            time.sleep(0.01)
        assert (now.run, now.status, now.said) == (second.id, btlang.Status.RUNNING, "hello")
        assert now.statuses == {"/": btlang.Status.RUNNING, "/0": btlang.Status.SUCCESS, "/1": btlang.Status.RUNNING}
        assert now.robot is not None
        assert now.robot.pose.distance_to((6.0, 6.2)) < 0.4  # where the mission before has left it
        second.stop()
        outcome = second.wait(10)
        assert outcome is not None
        assert outcome.stopped == "interrupted"
        events = list(second.events())
    assert second.id != first.id
    assert {event.run for event in events} == {second.id}
    assert isinstance(events[-1], Ended)
    changes = [change for event in events if isinstance(event, StatusesChanged) for change in event]
    assert [(c.path, c.before, c.status) for c in changes if c.path == "/0"] == [("/0", 4, 2), ("/0", 2, 1)]


def test_only_a_run_that_was_started_can_be_waited_for() -> None:
    with btlang.Session() as session:
        run = session.prepare(btlang.parse_tree("wait 1 s"), speed=1)
        with pytest.raises(RuntimeError, match="was started"):
            run.wait()
        assert run.wait(0.01) is None
        run.start()
        assert run.wait(0.01) is None
        assert run.wait().succeeded
        assert run.wait(0.01) is run.outcome


def test_of_a_long_run_only_the_latest_events_are_kept() -> None:
    with btlang.Session() as session:
        nodes = session.prepare(btlang.parse_tree("wave")).nodes
    recent, changes = RecentEvents(), [(0, 1, 4, None)] * 600
    for number in range(20):
        recent(StatusesChanged(0.0, "run", number, 0.0, changes, nodes))
    recent(Printed(0.0, "run", 20, 0.0, "x"))
    recent.close()
    kept = list(recent.events())
    assert [event.number for event in kept] == list(range(4, 21))  # 16 times 600 changes, and one


def test_an_emergency_stop_of_a_session_ends_a_run_that_is_prepared_too() -> None:
    with btlang.Session() as session:
        session.emergency_stop()  # without any run
        assert session.robot.stops == 1
        run = session.prepare(btlang.parse_tree("move forward 1 m"), speed="max")
        session.emergency_stop()
        outcome = run.execute()
        assert (outcome.stopped, outcome.ticks, session.robot.moving) == ("emergency stop", 0, False)
        session.emergency_stop()  # after it
        after = session.run(btlang.parse_tree("wave"), speed="max")
        assert after.outcome is not None
        assert after.outcome.succeeded


def test_every_line_of_a_log_fits_the_schema() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    output = io.StringIO()
    mission = btlang.parse_tree("say hi, print ho, grasp the cup if possible, move forward 9 m then fail")
    mission.run(speed="max", sinks=[JsonLog(output, mission.label)], time_limit=30)
    validator = jsonschema.Draft202012Validator(log_schema())
    lines = [json.loads(line) for line in output.getvalue().splitlines()]
    assert len(lines) > 10
    for line in lines:
        validator.validate(line)


@pytest.mark.parametrize("kind", LOGGED, ids=lambda kind: kind.__name__)
def test_every_event_has_its_place_in_the_schema(kind: type[Event]) -> None:
    [described] = [one for one in log_schema()["oneOf"] if one["title"] == kind.__name__]
    assert described["description"]
    event = kind(1.0, "r", 0, 2.0, *["x"] * (len(kind.fields) - len(Event.fields) - len(kind.field_defaults)))
    if kind.__name__ != "StatusChanged":
        assert set(as_json(event, str)) <= {*described["properties"], "t", "event", "number", "wall", "run"}
