"""For tests with real ROS 2: each has a domain of its own, stays on this machine, and ends what it started.

Without rclpy the whole folder is skipped.
"""

from __future__ import annotations

import fcntl
import importlib
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.ros import interfaces
from btlang.ros.available import require_interfaces
from tests.ros.domains import free_domain
from tests.ros.processes import REPOSITORY, ROOM, STARTED, Command, end_all

if TYPE_CHECKING:
    from tests.ros.client import Client

HERE = Path(__file__).parent
_NAV2, _OWN = "nav2_msgs.action", "btlang_interfaces.action"
_NAV2_NEWEST = ("nav2_msgs.action._dock_robot", "nav2_msgs.msg._speed_limit")
_COMPOSITION = "composition_interfaces.srv"


class _Skipped(pytest.Module):
    def collect(self) -> list[pytest.Item]:
        pytest.skip("ROS 2 is not installed: pip install 'btlang[ros]'", allow_module_level=True)


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> pytest.Module | None:
    return _Skipped.from_parent(parent, path=module_path) if find_spec("rclpy") is None else None


@pytest.fixture(scope="session", autouse=True)
def _isolated() -> Iterator[None]:
    """Nothing leaves this machine, and nodes find each other fast."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        patch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", str(HERE / "fast_discovery.xml"))
        patch.delenv("ROS_STATIC_PEERS", raising=False)
        yield


@pytest.fixture(autouse=True)
def _processes_end() -> Iterator[None]:
    """Also those of a test that fails; not those of fixtures that several tests share, which are made before this."""
    first = len(STARTED)
    yield
    end_all(first)


@pytest.fixture
def domain() -> Iterator[int]:
    """The number of a domain that no other test on this machine uses at the same time."""
    with free_domain() as number:
        yield number


@pytest.fixture(scope="session", autouse=True)
def _interfaces() -> None:
    """Compiles btlang's own, and what Nav2 and containers would bring, once for all; else tests skip."""
    packages = {
        _NAV2: str(HERE / "nav2_msgs"), _OWN: "--own", _COMPOSITION: str(HERE / "composition_interfaces")
    }  # fmt: skip
    with _lock(Path(sys.prefix, ".btlang-interfaces.lock")):
        there = {_NAV2: all(map(_found, _NAV2_NEWEST)), _OWN: _is_current(), _COMPOSITION: _found(_COMPOSITION)}
        missing = [folder for module, folder in packages.items() if not there[module]]
        if not missing or interfaces.find_missing_tools() is not None:
            return
        command = [sys.executable, "-m", "btlang.ros.interfaces", *missing]
        environment = {**os.environ, "PYTHONPATH": str(REPOSITORY)}
        subprocess.run(command, env=environment, check=True, timeout=500, stdout=subprocess.DEVNULL)
    importlib.invalidate_caches()


@pytest.fixture
def nav2() -> Any:
    """The action NavigateToPose."""
    if not _found(_NAV2):
        pytest.skip(f"nav2_msgs is not installed and cannot be compiled: {interfaces.find_missing_tools()}")
    return importlib.import_module(_NAV2).NavigateToPose


@pytest.fixture
def run_mission() -> Any:
    """The action RunMission."""
    if not _found(_OWN):
        pytest.skip(f"btlang_interfaces is not installed and cannot be compiled: {interfaces.find_missing_tools()}")
    return importlib.import_module(_OWN).RunMission


@pytest.fixture
def composition() -> None:
    """The interfaces of component containers."""
    if not _found(_COMPOSITION):
        pytest.skip(f"composition_interfaces can't be compiled: {interfaces.find_missing_tools()}")


@pytest.fixture
def start_node(tmp_path: Path, domain: int, run_mission: Any) -> Iterator[Callable[..., Command]]:
    """Starts `btc ros-node` in a process of its own; it has to end as asked, without a traceback."""
    started: list[Command] = []

    def start(*options: str) -> Command:
        folder = tmp_path / f"node{len(started)}"
        folder.mkdir()
        command = Command(folder, domain, "ros-node", *options)
        started.append(command)
        command.wait_for("ready")
        return command

    yield start
    codes = [command.end() for command in started]
    assert set(codes) <= {130, 131, 143}
    assert not any("Traceback" in command.out + command.err for command in started)


@pytest.fixture
def client(domain: int) -> Iterator[Client]:
    """A user's program in this process."""
    from tests.ros.client import Client

    client = Client(domain)
    yield client
    client.close()


@pytest.fixture
def start_sim(tmp_path: Path, domain: int) -> Iterator[Callable[..., Command]]:
    """Starts `btc sim-ros` in a process of its own; it has to end as asked, and to complain of nothing."""
    started: list[Command] = []

    def start(*options: str, **environment: str | None) -> Command:
        folder = tmp_path / f"sim{len(started)}"
        folder.mkdir()
        arguments = ["sim-ros", "--world", str(ROOM), "--speed", "10", *options]
        command = Command(folder, domain, *arguments, **environment)
        started.append(command)
        command.wait_for("ready")
        return command

    yield start
    codes = [command.end() for command in started]
    assert set(codes) <= {129, 130, 143}
    assert [command.err for command in started] == [""] * len(started)


@pytest.fixture
def sim(start_sim: Callable[..., Command]) -> Command:
    """The simulated robot in the room of `room.toml`, at 10 times real time."""
    return start_sim()


def _is_current() -> bool:
    try:
        require_interfaces()
    except MissionError:
        return False
    return True


def _found(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:
        return False


@contextmanager
def _lock(path: Path) -> Iterator[None]:
    with path.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
