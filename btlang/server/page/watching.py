"""The page that shows a run or a recording to the user who started it, without a way to command the robot."""

from __future__ import annotations

import asyncio
import json
import os
import re
import threading
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, closing, contextmanager, suppress
from functools import partial

from starlette.routing import BaseRoute

from btlang.api import Mission
from btlang.recording.reader import read_recording
from btlang.robots.bodies.urdf import urdf
from btlang.robots.worlds.world_file import read_world
from btlang.run.controls import Controls
from btlang.run.terminal import EMERGENCY_STOPPED
from btlang.run.world_input import WorldInput
from btlang.server.accounts.accounts import Accounts, UserRole
from btlang.server.live.robot_connection import LONGEST
from btlang.server.live.robot_feeds import RobotFeed
from btlang.server.page.local_page import LocalApi, LocalPage, LocalRobots, local_page, say_where
from btlang.session import Run
from btlang.task.live.feed import Feed, NoTasks
from btlang.task.messages import Answer, EmergencyStop, List
from btlang.task.messages import Urdf as UrdfCommand
from btlang.text.formatting import one_line
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Body
    from btlang.robots.worlds.world import World
    from btlang.run.events import Sink

_PATIENCE = 10.0  # seconds for which a run waits for the page
_ROUTES = ("/api/login", "/api/me", "/api/robots", "/api/stop", "/api/commands", "/api/ws", "/", "/login", "/page")
_OF_RECORDING = ("/api/films/{name}", "/api/trees/{name}", "/api/recordings/{name}")


class WatchApi(LocalApi):
    """The server for somebody who watches: what shows a robot, or a recording, and the emergency stop."""

    role = UserRole.VIEWER

    def routes(self) -> list[BaseRoute]:
        """Return only the routes that its screen asks for."""
        shown = {*_ROUTES, *_OF_RECORDING}
        return [route for route in super().routes() if getattr(route, "path", "") in shown]


class PageMonitor:
    """A monitor that shows a run on a page; see run_mission (run/terminal.py).

    It's also the connection of `feed`, the page's robot.

    `world` is None for a robot whose map isn't known.
    """

    hooks = None

    def __init__(self, name: str, world: World | None, body: Body | None) -> None:
        self.feed = RobotFeed(name, self)
        self._body = body
        self._controls = Controls()
        self._emergency = ""
        self._input = WorldInput()  # which knows what the robot asks
        self._feed = Feed(
            NoTasks(), self._state, {}, world, parts=lambda: {"components": [], "devices": []},
            question=lambda: self._input.question,
        )  # fmt: skip
        self.page: LocalPage

    @contextmanager
    def opened(self, controls: Controls) -> Iterator[PageMonitor]:
        """Give the monitor as long as the run lasts."""
        self._controls = controls
        yield self

    def watch_run(self, run: Run, mission: Mission) -> None:
        """Show a run, once the page is there."""
        sinks: list[Sink] = [self._input, *self._feed.sinks(1, mission, run)]
        for sink in sinks:
            run.bus.add(sink)
        self._feed.wake()
        end = time.monotonic() + _PATIENCE
        while not self.feed.is_watched and time.monotonic() < end:  # what happens before is in no page's log
            time.sleep(0.05)

    def stay(self, code: int) -> int:
        """Leave the end of the run on the page until that is closed; return the exit code of the run."""
        if code < 128 or code == EMERGENCY_STOPPED:
            show("The page shows the end of the run. Close it, or press Ctrl-C.")
            self.page.wait(lambda: self.page.was_left)
        return code

    async def ask(self, message: dict[str, Any]) -> Any:
        """Answer what the page needs to show the robot, and refuse the rest; see RobotConnection."""
        tag = message.get("command")
        if tag == List.tag:
            return Answer(True, "", {"tasks": []}, "").as_json()
        if tag == UrdfCommand.tag and self._body is not None and any(joint.link for joint in self._body.joints):
            return Answer(True, "", {"urdf": urdf(self._body)}, "").as_json()
        if tag == EmergencyStop.tag:
            return Answer(True, "", {}, "").as_json()
        return Answer(False, "This page only watches.", {}, "").as_json()

    async def stop(self) -> None:
        """See `btlang.server.live.robot_connection.RobotConnection`."""
        self._emergency = "emergency stop by the page"
        await asyncio.to_thread(self._controls.emergency_stop)
        self._feed.wake()

    async def read(self, message: dict[str, Any]) -> Any:
        """See `btlang.server.live.robot_connection.RemoteConnection`."""
        raise ConnectionError("a run has no recordings")

    @asynccontextmanager
    async def watch(self, request: dict[str, Any]) -> AsyncIterator[asyncio.StreamReader]:
        """See `btlang.server.live.robot_connection.RobotConnection`. The feed waits for news in a thread."""
        reader, loop, is_over = asyncio.StreamReader(limit=LONGEST), asyncio.get_running_loop(), threading.Event()

        def send() -> None:
            with closing(self._feed.watch(**request)) as messages, suppress(RuntimeError):  # the loop may be closed
                for message in messages:
                    if is_over.is_set():
                        return
                    loop.call_soon_threadsafe(reader.feed_data, json.dumps(message, default=str).encode() + b"\n")

        threading.Thread(target=send, name="btlang page feed", daemon=True).start()
        try:
            yield reader
        finally:
            is_over.set()
            self._feed.wake()

    def _state(self) -> dict[str, Any]:
        return {
            "stopped": self._emergency, "paused": self._controls.paused, "hindrance": "", "visitors": False,
            "talks": False,
        }  # fmt: skip


@contextmanager
def open_monitor(mission: Mission, name: str, body: Body, is_simulated: bool, browser: bool) -> Iterator[PageMonitor]:
    """Give a monitor that shows a run on a page. `is_simulated`: the robot moves in the world of the mission."""
    world = read_world(mission.world, body) if is_simulated or mission.world is not None else None
    monitor = PageMonitor(name, world, body)
    robots = LocalRobots(monitor.feed)
    with local_page(lambda accounts, port, _: WatchApi(accounts, port, ("robots", name), robots)) as page:
        say_where(page, f"Watch {one_line(name)}", browser)
        show(f"The run begins when the page is open, or after {_PATIENCE:.0f} s.")
        monitor.page = page
        yield monitor


def serve(path: str, browser: bool) -> int:
    """Show a recording on a page until that is closed; return the exit code. Raises MissionError."""
    about = read_recording(path).about  # what isn't a recording says so at once
    name = about.get("mission") or "the run"
    with local_page(partial(_recording_api, path)) as page:
        say_where(page, f"Watch {one_line(name)}", browser)
        show("End with Ctrl-C, or close the page.")
        return page.wait(lambda: page.was_left)


def _recording_api(path: str, accounts: Accounts, port: int, folder: str) -> WatchApi:
    """Return the server of one recording, which is in a folder of its own under a name that an address can have."""
    feed = RobotFeed(re.sub(r"\.mcap$", "", os.path.basename(path)) or "recording")
    os.symlink(os.path.abspath(path), os.path.join(folder, "recording.mcap"))
    feed.recordings = folder
    api = WatchApi(accounts, port, ("runs", feed.name, "recording.mcap"), LocalRobots())
    api.robots.feeds[feed.name] = feed  # it isn't followed: there's only its recording
    return api
