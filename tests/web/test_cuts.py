"""The page in a browser while its server and its robot go and come back."""

from __future__ import annotations

import os
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from tests.profiles import only_long
from tests.server.doors import PASSWORD, Door, Program
from tests.web.packages import ROOT, installed, node

HERE = Path(__file__).parent


@contextmanager
def switchboard(switches: dict[str, Callable[[], object]]) -> Iterator[str]:
    """An address where a script, by POST /NAME, does what has this name."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            switches[self.path.removeprefix("/")]()
            self.send_response(204)
            self.end_headers()

        def log_message(self, format: str, *arguments: object) -> None: ...

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()


@only_long
def test_a_server_and_a_robot_that_go_lose_nothing(page: Path) -> None:
    with ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="bt"))
        environment = {**os.environ, "XDG_DATA_HOME": folder, "XDG_RUNTIME_DIR": folder}
        world = str(ROOT / "examples" / "worlds" / "museum.toml")
        robot = stack.enter_context(closing(Program(environment, "robot", "up", "--world", world, "--speed", "4")))
        robot.start("The robot 'robot' is up")
        door = stack.enter_context(closing(Door(Path(folder))))
        door.user("add", "ed", "--role", "editor")
        switches = {
            "kill-server": door.kill,
            "start-server": door.start,
            "log-out": lambda: door.user("logout", "ed"),
            "kill-robot": robot.kill,
            "start-robot": lambda: robot.start("The robot 'robot' is up"),
        }
        switch = stack.enter_context(switchboard(switches))
        node(HERE / "cuts.mjs", f"https://127.0.0.1:{door.port}", PASSWORD, switch, folder=installed(HERE))
