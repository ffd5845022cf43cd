"""Commands that work beside the tick, from keyword files and from Python, in whole runs."""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import FAILURE, SUCCESS
from btlang.run import runner
from btlang.run.events import Troubled
from tests.conftest import without_overruns
from tests.trial import Trial

REPOSITORY = Path(__file__).parent.parent.parent
PATIENCE = 20.0
HELD_UP = 10.0
"""Seconds from the halt to the end of the process, of which a straggler gets two."""

WORDS = """
[[action]]
phrase = "ask {text}"
id = "Ask"
call = "services:ask"

[[action]]
phrase = "compute"
id = "Compute"
call = "services:compute"
thread = true

[[action]]
phrase = "brood"
id = "Brood"
call = "services:brood"
thread = true

[[action]]
phrase = "muse"
id = "Muse"
call = "services:muse"

[[action]]
phrase = "doze"
id = "Doze"
call = "services:doze"
"""
SERVICES = """
import asyncio, time, btlang

async def ask(text, clock):
    await asyncio.sleep(0.05)
    if text == "nobody":
        raise btlang.ActionFailed("nobody answers")
    if text == "everybody":
        raise KeyError(text)

def compute(halted):
    assert not halted.wait(0.05)

def brood():
    while True:
        time.sleep(0.01)

async def muse():
    while True:
        try:
            await asyncio.sleep(60)
        except asyncio.CancelledError:
            pass

async def doze():
    await asyncio.to_thread(time.sleep, 0.01)
    await asyncio.to_thread(time.sleep, 1000)
"""


def btc(folder: Path, mission: str, *options: str) -> subprocess.CompletedProcess[str]:
    """`btc run` with the words above."""
    (folder / "words.toml").write_text(WORDS)
    (folder / "services.py").write_text(SERVICES)
    return subprocess.run(
        [sys.executable, "-m", "btlang", "run", "-c", mission, "--keywords", str(folder / "words.toml"), *options],
        env={**os.environ, "PYTHONPATH": str(REPOSITORY)}, text=True, capture_output=True, check=False, timeout=60,
    )  # fmt: skip


def lines(output: str) -> list[str]:
    """The lines of a run without their times, sorted by nothing but the run."""
    return [line[9:] for line in without_overruns(output).splitlines()[:-1]]


def test_async_functions_and_threads_from_a_keyword_file(tmp_path: Path) -> None:
    done = btc(tmp_path, 'ask "the way" and compute; try to ask nobody, otherwise say sorry', "--rate", "1")
    assert (done.returncode, done.stderr) == (0, "")
    told = lines(done.stdout)
    assert set(told[:4]) == {'start  ask "the way"', "start  compute", 'done   ask "the way"', "done   compute"}
    assert told[4:6] == ['start  ask "nobody"', 'failed ask "nobody": nobody answers']
    assert told[6:8] == ["start  say sorry", 'says   "sorry"']
    seconds = float(done.stdout.splitlines()[-1].removeprefix("The mission succeeded in ").removesuffix(" s."))
    assert seconds < 2.5  # at 1 tick a second it would be 3 or more without the wake-ups


def test_an_exception_fails_with_its_sentence_and_no_traceback(tmp_path: Path) -> None:
    done = btc(tmp_path, "ask everybody")
    assert done.returncode == 1
    assert "  Ask: KeyError: 'everybody'\n" in done.stderr
    assert "Traceback" not in done.stdout + done.stderr


@pytest.mark.parametrize("command", ["brood", "muse"])
def test_one_that_does_not_end_is_told_and_does_not_hold_up_the_process(tmp_path: Path, command: str) -> None:
    log = tmp_path / "log.jsonl"
    done = btc(tmp_path, f"say go then {command}", "--for", "1.5", "--log", str(log))
    ended = time.time()
    assert (done.returncode, done.stderr) == (0, "")
    told = [line for line in lines(done.stdout) if line.startswith(("halted", "error"))]  # a busy machine adds warnings
    assert told == [f"halted {command}", f"error  {command} did not end after it was halted"]
    events = [json.loads(line) for line in log.read_text().splitlines()]
    [error] = [event for event in events if event.get("event") == "error"]
    assert (error["path"], error["place"]) == ("/1", "<command line>:1:13")
    [halted] = [event for event in events if (event.get("path"), event.get("status")) == ("/1", "IDLE")]
    assert ended - halted["wall"] < HELD_UP


def test_a_thread_that_an_async_function_waits_for_does_not_hold_up_the_process_either(tmp_path: Path) -> None:
    done = btc(tmp_path, "doze", "--for", "0.5")
    assert (done.returncode, done.stderr) == (0, "")
    assert lines(done.stdout) == ["start  doze", "halted doze"]


class Thought:
    """A thread that works until it is halted or told to end."""

    def __init__(self) -> None:
        self.begun, self.done, self.ended = threading.Event(), threading.Event(), threading.Event()
        self.runs = 0

        @btlang.action("ponder", thread=True)
        def ponder(halted: threading.Event) -> None:
            self.runs += 1
            self.begun.set()
            while not halted.is_set() and not self.done.wait(0.001):
                pass
            self.ended.set()

        self.word = ponder


def test_its_end_is_noticed_well_before_the_period_is_over() -> None:
    at: list[float] = []

    @btlang.action("ponder", thread=True)
    def ponder() -> None:
        time.sleep(0.05)
        at.append(time.monotonic())

    @btlang.action("go on")
    def go_on() -> None:
        at.append(time.monotonic())

    outcome = btlang.parse_tree("ponder then go on", keywords=[ponder, go_on]).run(rate=1)
    assert (outcome.status, outcome.ticks) == (SUCCESS, 2)
    assert at[1] - at[0] < 0.7
    assert 0.04 < outcome.seconds < 0.9


def test_a_pause_cancels_it_and_resuming_starts_it_anew() -> None:
    thought = Thought()
    tree = Trial("ponder", keywords=[thought.word])
    outcomes: list[Any] = []
    thread = threading.Thread(target=lambda: outcomes.append(tree.run()))
    thread.start()
    assert thought.begun.wait(PATIENCE)
    tree.controls.pause()
    assert thought.ended.wait(PATIENCE)
    thought.begun.clear()
    tree.controls.resume()
    assert thought.begun.wait(PATIENCE)
    thought.done.set()
    thread.join(PATIENCE)
    assert (outcomes[0].status, thought.runs) == (SUCCESS, 2)


@pytest.mark.parametrize("how", ["stop", "emergency_stop"])
def test_the_end_of_a_run_halts_it(how: str) -> None:
    thought = Thought()
    tree = Trial("ponder", keywords=[thought.word])
    errors: list[Troubled] = []
    outcomes: list[Any] = []
    sink = lambda event: errors.append(event) if isinstance(event, Troubled) else None  # noqa: E731
    thread = threading.Thread(target=lambda: outcomes.append(tree.run(rate=1, sinks=[sink])))
    thread.start()
    assert thought.begun.wait(PATIENCE)
    began = time.monotonic()
    getattr(tree.controls, how)()
    assert thought.ended.wait(PATIENCE)
    thread.join(PATIENCE)
    assert time.monotonic() - began < runner._PATIENCE  # nobody waited for a straggler; one period of rest is 1 s
    assert outcomes[0].stopped == {"stop": "interrupted", "emergency_stop": "emergency stop"}[how]
    assert errors == []


def test_a_time_limit_halts_it() -> None:
    thought = Thought()
    outcome = btlang.parse_tree("ponder", keywords=[thought.word]).run(speed=10, time_limit=0.5)
    assert (outcome.stopped, thought.ended.is_set()) == ("time limit", True)


def test_ticks_by_hand_and_a_halt_between_them() -> None:
    thought = Thought()
    tree = Trial("ponder", keywords=[thought.word])
    tree.tick()
    assert thought.begun.wait(PATIENCE)
    tree.halt()
    assert thought.ended.is_set()  # the halt of a tree waits for it
    thought.done.set()
    until = time.monotonic() + PATIENCE
    while (status := tree.tick()) != SUCCESS:
        assert status != FAILURE
        assert time.monotonic() < until
    assert thought.runs == 2


def test_an_asynchronous_condition_is_refused() -> None:
    @btlang.condition("it rains")
    async def it_rains() -> bool:
        await asyncio.sleep(0)
        return True

    with pytest.raises(MissionError, match="asynchronous"):
        btlang.parse_tree("if it rains, wave", keywords=[it_rains]).run(speed="max")
