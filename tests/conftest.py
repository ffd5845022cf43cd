"""Shared by all tests: hypothesis settings, and golden files that `UPDATE_GOLDEN=1` writes anew."""

from __future__ import annotations

import atexit
import gc
import getpass
import os
import re
import shutil
import signal
import socket
import sys
import tempfile
import time
from collections.abc import Generator, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from itertools import groupby
from pathlib import Path
from types import ModuleType
from typing import IO

import pytest
from hypothesis import HealthCheck, settings

from btlang.support import gc_pause
from btlang.text.source import Source
from tests import forked, made_once  # noqa: F401 (the folder of `made_once` is that of the first process)
from tests.profiles import LONG

settings.register_profile(
    "ci", deadline=None, derandomize=True, database=None, suppress_health_check=[HealthCheck.too_slow]
)
for variable in ("FORCE_COLOR", "CLICOLOR_FORCE"):  # what is compared is plain text
    os.environ.pop(variable, None)
os.environ["XDG_STATE_HOME"] = tempfile.mkdtemp(prefix="btlang-state-")  # the user's own latest run stays
atexit.register(shutil.rmtree, os.environ["XDG_STATE_HOME"], ignore_errors=True)
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # hundreds of commands are started: each would compile btlang anew
sys.dont_write_bytecode = False  # and each worker the tests
# with shared memory, who writes to a peer that was killed may wait for a second, and the next in its domain prints an
# error about locked ports (Fast DDS 5737, 6117)
os.environ["FASTDDS_BUILTIN_TRANSPORTS"] = "UDPv4"

for number, usual in (
    (signal.SIGINT, signal.default_int_handler), (signal.SIGQUIT, signal.SIG_DFL), (signal.SIGHUP, signal.SIG_DFL),
    (signal.SIGTERM, signal.SIG_DFL),
):  # fmt: skip
    if signal.getsignal(number) == signal.SIG_IGN:  # as with `nohup ... &`: what tests start would inherit that
        signal.signal(number, usual)

OVER_DDS = ("tests/ros/", "tests/diagnostics/test_pages.py::test_examples[BT107]")
"""Tests of programs that find one another over DDS, each of which must be quick enough for the others."""
_FOLDERS = ("components", "devices", "lies", "lsp", "monitor", "server", "speech", "task", "terminal", "web")
IN_REAL_TIME = (*OVER_DDS, *(f"tests/{folder}/" for folder in _FOLDERS))
"""Tests whose processes wait for one another, and for the clock: what only computes gives way to them."""
_WAITING = {"asyncio", "subprocess", "threading", "time"}
"""What a module of tests imports whose tests do so, too, in whatever folder it is."""
_AT_ONCE = 2
"""The tests of OVER_DDS that run at a time: they wait most of the time. Of three on two cores some come too late."""
LONGEST = (
    "tests/backends/test_grammar.py::test_both_parsers_read_what_the_grammar_makes",
    "tests/backends/test_grammar.py::test_every_rule_that_is_used_is_there",
    "tests/components/test_faults.py::test_twenty_components_in_a_storm",
    "tests/components/test_new.py::test_a_robot_with_words_as_its_readme_says",
    "tests/guide/test_guide.py::test_weeks_of_the_museum",
    "tests/lsp/test_session.py::test_a_session_of_edits_ends_as_a_fresh_text",
    "tests/server/test_mcp.py::test_a_model_writes_checks_mends_and_simulates_a_mission",
    "tests/task/test_museum_week.py::",
)
"""Tests that take more than five seconds: they begin early, so that no core waits for the last one."""
_WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
_GIVING_WAY, _FIRST = 15, -10
"""How nice a test that only computes is, and one over DDS."""


def _may_go_first() -> bool:
    """Whether this process may become less nice. Root may not in every container."""
    try:
        os.setpriority(os.PRIO_PROCESS, 0, _FIRST)
    except (AttributeError, PermissionError):  # Windows has no priorities
        return False
    os.setpriority(os.PRIO_PROCESS, 0, 0)
    return True


_MAY_GO_FIRST = _may_go_first()


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> None:
    """Tests run in several processes (`-n0`: in one), unless the command line says how many."""
    if config.option.numprocesses is None and "PYTEST_XDIST_WORKER" not in os.environ:
        config.option.numprocesses, config.option.dist = "auto", "worksteal"


def pytest_configure(config: pytest.Config) -> None:
    """`-m long` is known before the tests are read, which leave no garbage. The profile "ci" of hypothesis draws the
    same examples each time; `--hypothesis-profile=default` draws new ones.
    """
    if config.option.hypothesis_profile is None:
        settings.load_profile("ci")
    if config.option.markexpr == "long":
        os.environ[LONG] = "1"
    gc.disable()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """A test over DDS waits for its turn, and one that only computes gives way to those that can't wait."""
    over_dds = item.nodeid.startswith(OVER_DDS)
    _be_nice(_FIRST if over_dds else 0 if _in_real_time(item) else _GIVING_WAY)
    if not over_dds:
        return (yield)
    with _turn():
        return (yield)


def _in_real_time(item: pytest.Item) -> bool:
    """Whether a test waits for other processes or the clock."""
    names = vars(item.module) if isinstance(item, pytest.Function) else {}
    return item.nodeid.startswith(IN_REAL_TIME) or not _WAITING.isdisjoint(names)


def _be_nice(niceness: int) -> None:
    """Sets how nice this process and those that it starts are. Most users can't become less nice again."""
    if _MAY_GO_FIRST:
        os.setpriority(os.PRIO_PROCESS, 0, niceness)
    elif hasattr(os, "nice") and _WORKER >= _AT_ONCE and os.nice(0) == 0:
        os.nice(_GIVING_WAY)


@contextmanager
def _turn() -> Iterator[None]:
    """One of the turns that tests over DDS take, of all runs of the suite on this machine."""
    with ExitStack() as stack:
        paths = [Path(tempfile.gettempdir(), f"btlang-tests-{getpass.getuser()}-{turn}") for turn in range(_AT_ONCE)]
        files = [stack.enter_context(path.open("w")) for path in paths]
        while not any(map(_locked, files)):
            time.sleep(0.05)
        yield


def _locked(file: IO[str]) -> bool:
    """Whether the file is this process's alone from now on, until it is closed."""
    import fcntl  # which Windows hasn't, where no test over DDS runs

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def pytest_xdist_auto_num_workers() -> int | None:
    """Three more than there are cores: two wait for tests over DDS, one for others in real time, and two compute."""
    return None if "PYTEST_XDIST_AUTO_NUM_WORKERS" in os.environ else (os.cpu_count() or 1) + _AT_ONCE + 1


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Each worker first gets as many tests of the list as the others, in a row: some begin with what takes longest."""
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    chains: list[list[pytest.Item]] = [[] for _ in range(min(_AT_ONCE, workers))]
    over_dds = (item for item in items if item.nodeid.startswith(OVER_DDS))
    for number, (_, module) in enumerate(groupby(over_dds, key=lambda item: item.path)):
        chains[number % len(chains)] += module
    if workers > len(chains):
        chains.append([item for item in items if item.nodeid.startswith("tests/web/")])
    first = {item for chain in chains for item in chain}
    others = [item for item in items if item not in first and not item.nodeid.startswith(LONGEST)]
    longest = [item for item in items if item not in first and item.nodeid.startswith(LONGEST)]
    share, ordered = len(items) // workers, list[pytest.Item]()
    for chain in chains:
        beside = max(0, share - len(chain))
        ordered += [*chain, *others[:beside]]
        others = others[beside:]
    items[:] = [*ordered, *longest, *others]


def pytest_collection_finish() -> None:
    """Most tests leave little garbage, and looking for it took a tenth of all time. What was collected isn't frozen:
    else the search would also go through each vocabulary that is made.
    """
    gc_pause._LOOK_AFTER = 10_000_000
    gc.set_threshold(20_000, 20, 20)
    gc.enable()


def pytest_sessionfinish() -> None:
    """Nothing that tests have started goes on. What is garbage goes now; then pytest looks for more five times."""
    forked.end()
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def _shipped_words_are_read_once() -> Iterator[None]:
    """Hundreds of tests make a vocabulary of a file of their own and of those that ship, which never change."""
    from btlang.vocabulary import keyword_file

    read, known = keyword_file.read_keyword_file, dict[tuple[str, str], keyword_file.KeywordFile]()

    def read_once(source: Source) -> keyword_file.KeywordFile:
        if not source.name.startswith("keywords/"):  # where none ships
            return read(source)
        key = source.name, source.text
        if key not in known:
            known[key] = read(source)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(keyword_file, "read_keyword_file", read_once)
        yield


def without_overruns(printed: str) -> str:
    """What a run prints, without the lines about slow ticks, which a busy machine adds."""
    return re.sub(r"(?m)^ *\S+ +slow .*\n|^\d+ of \d+ ticks took too long;.*\n", "", printed)


def without_pointer(errors: str) -> str:
    """Messages without the last line, which says where to read more about them."""
    return re.sub(r"\nFor more, run: .*\n", "", errors)


def matches_golden(actual: str, path: Path) -> None:
    """Fails where a text is not the one in a file."""
    if os.environ.get("UPDATE_GOLDEN"):
        path.write_text(actual, encoding="utf-8")
    if not path.exists():
        pytest.fail(f"{path.name} is missing; UPDATE_GOLDEN=1 writes it (then read it)")
    assert actual == path.read_text(encoding="utf-8"), f"{path.name} differs"


os.environ["BTC_DEBUG"] = "1"  # a bug fails the test with its traceback


def take_away_what_is_missed(code: str, patch: pytest.MonkeyPatch) -> None:
    """So that a message about what is missed can be shown: matplotlib, ROS 2, or a robot that speaks it."""
    if code == "BT099":
        patch.delenv("BTC_DEBUG")
        patch.setenv("XDG_STATE_HOME", "/dev/null")  # where nothing can be written
        patch.setattr("btlang.vocabulary.listing.overview", _buggy)
    patch.setitem(sys.modules, "matplotlib", None)  # BT081
    patch.setitem(sys.modules, "mcp", None)  # BT082
    patch.setitem(sys.modules, "pygls", None)
    if code == "BT085":
        patch.setitem(sys.modules, "msgpack", None)
    if code == "BT087":
        patch.setitem(sys.modules, "yaml", None)
    if code == "BT200":
        patch.setitem(sys.modules, "argon2", None)
    if code == "BT211":
        patch.setattr("btlang.server.page.local_page.PAGE", Path("nowhere"))
    if code == "BT189":
        patch.setitem(sys.modules, "psycopg", None)
    if code == "BT086":
        _taken(64_998)
    if code not in ("BT101", "BT107"):  # what ROS 2 has loaded before would miss its own
        patch.setitem(sys.modules, "btlang_interfaces", None)  # BT110
        patch.setitem(sys.modules, "rclpy", ModuleType("rclpy") if code == "BT110" else None)  # BT100
        return
    pytest.importorskip("rclpy", reason="ROS 2 is not installed")
    if code == "BT107":
        return
    patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")
    for waited in ("_DISCOVERY", "_AGAIN"):
        patch.setattr(f"btlang.ros.robot.connection.{waited}", 0.5)  # seconds: it finds nobody


@cache
def _taken(port: int) -> socket.socket:
    """Takes a port for the rest of the process, unless it is taken already."""
    taken = socket.socket()
    atexit.register(taken.close)
    with suppress(OSError):
        taken.bind(("127.0.0.1", port))
        taken.listen()
    return taken


def _buggy(*_: object) -> list[str]:
    raise ZeroDivisionError("division by zero")
