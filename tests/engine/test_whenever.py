"""Whenever: what is kept of the work that a reaction interrupts, and rules inside rules."""

from __future__ import annotations

from btlang.engine.status import IDLE

from .scripted import World, n


def test_the_work_keeps_positions_and_counts() -> None:
    world = World()
    work = n("Repeat", n("Sequence", world.fn("A", "s"), world.cls("W", "rs")), num_cycles=2)
    engine = world.engine(n("Whenever", world.fn("C", "ffsffff"), world.fn("B", "s"), work))
    assert world.ticks(engine, 3) == "rrs"
    calls = [entry for entry in world.log if entry != "C"]
    # W of the second round is interrupted and starts anew, A does not run again, and the second round is the last
    assert calls == ["A", "W.start", "W.tick", "A", "W.start", "W.halt", "B", "W.start"]


def test_timers_of_the_work_stand_still_meanwhile() -> None:
    world = World()
    engine = world.engine(n("Whenever", world.fn("C", "fs" + "f" * 8), world.cls("B", "rs"), n("Sleep", msec=1000)))
    letters = ""
    while "s" not in letters:
        letters += world.ticks(engine, 1)
        world.clock.advance(0.5)
    assert letters == "rrrs"  # the 0.5 s of the reaction do not count


def test_a_halt_halts_whichever_runs_and_arms_the_rule() -> None:
    world = World()
    engine = world.engine(n("Whenever", world.fn("C", "fss"), world.cls("B", "r"), world.cls("W", "r")))
    world.ticks(engine, 2)
    assert world.since() == ["C", "W.start", "C", "W.halt", "B.start"]
    engine.halt()
    assert world.since() == ["B.halt"]
    engine.tick()
    assert world.since() == ["C", "B.start"]  # the condition still holds, and the start counts


def test_a_suspended_reaction_is_taken_up_again() -> None:
    world = World()
    engine = world.engine(n("Whenever", world.fn("C", "sf"), world.cls("B", "rrs"), world.cls("W", "r")))
    engine.tick()
    engine.suspend()
    assert world.since() == ["C", "B.start", "B.halt"]
    engine.tick()
    assert world.since() == ["C", "B.start"]


def test_the_outer_rule_wins_and_interrupts_the_inner_reaction() -> None:
    world = World()
    inner = n("Whenever", world.fn("C", "s"), world.cls("B", "r"), world.cls("W", "r"))
    engine = world.engine(n("Whenever", world.fn("D", "fs"), world.cls("A", "s"), inner))
    assert world.ticks(engine, 2) == "rr"
    assert world.log == ["D", "C", "B.start", "D", "B.halt", "A.start", "C", "B.start"]


def test_a_condition_that_holds_for_some_time_triggers_once_until_it_is_false() -> None:
    world = World()
    held = n("ReactiveSequence", world.fn("C", "ss" + "s" * 4 + "fss"), n("Sleep", msec=1000))
    engine = world.engine(n("Whenever", held, world.fn("B", "s"), world.cls("W", "r")))
    for _ in range(9):
        world.ticks(engine, 1)
        world.clock.advance(1)
    # true from tick 1 on, so it holds at tick 2; false at tick 7, true again from tick 8 on, so it holds at tick 9
    assert [entry for entry in world.log if entry in ("B", "W.start")] == ["W.start", "B", "W.start", "B", "W.start"]


def test_statuses_are_reported() -> None:
    world = World()
    engine = world.engine(n("Whenever", world.fn("C", "fs"), world.cls("B", "s"), world.cls("W", "r")), watched=True)
    world.ticks(engine, 2)
    assert (3, IDLE) in world.changes  # the work was halted
    assert world.changes[-1][0] == 3
