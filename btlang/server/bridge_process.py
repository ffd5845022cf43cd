"""The process that speaks to ROS 2 for the server, which imports no ROS itself."""

from __future__ import annotations

import asyncio
import json
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Callable
from contextlib import suppress

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Heard = Callable[[dict[str, Any], str], object]

_LONGEST = 1_000_000  # bytes of a line
_PATIENCE = 10.0  # seconds for it to take what is written
_ENDING = 4.0  # seconds for it to end by itself


class BridgeProcess:
    """See `btlang.ros.bridge`. In one event loop.

    `heard` gets both parts of each line that it writes, `ended` its reason, if it gave one, when it is gone.
    """

    def __init__(self, heard: Heard, ended: Callable[[str], object]) -> None:
        self._heard, self._ended = heard, ended
        self._process: Process | None = None
        self._reading: asyncio.Task[None] | None = None
        self._turn = asyncio.Lock()

    async def start(self) -> None:
        """Starts it, unless it is up. Raises OSError."""
        async with self._turn:
            if self._process is None:
                command = (sys.executable, "-P", "-m", "btlang.ros.bridge")
                self._process = await asyncio.create_subprocess_exec(
                    *command, stdin=PIPE, stdout=PIPE, limit=_LONGEST, start_new_session=True
                )
                self._reading = asyncio.create_task(self._read(self._process))

    def write(self, data: dict[str, Any]) -> None:
        """A line for it; does nothing if it is gone."""
        if self._process is not None and self._process.stdin is not None:
            self._process.stdin.write(json.dumps(data).encode() + b"\n")

    async def drain(self) -> None:
        """Until it has taken most of what was written. One that takes nothing any more is ended."""
        process = self._process
        if process is None or process.stdin is None:
            return
        try:
            async with asyncio.timeout(_PATIENCE):
                await process.stdin.drain()
        except TimeoutError:
            _kill(process)
        except OSError:
            return

    async def close(self) -> None:
        """Ends it: it lets go of the robot first."""
        process, reading = self._process, self._reading
        if process is None or process.stdin is None or reading is None:
            return
        process.stdin.close()
        await asyncio.wait({reading}, timeout=_ENDING)
        _kill(process)
        await process.wait()

    async def _read(self, process: Process) -> None:
        assert process.stdout is not None
        problem = ""
        try:
            while line := await process.stdout.readline():
                about, _, text = line.decode().rstrip("\n").partition("\t")
                data = json.loads(about)
                problem = data.get("problem", "")
                if not problem:
                    self._heard(data, text)
        except ValueError:  # a line that is longer than any that it writes
            _kill(process)
        finally:
            self._process = None
            self._ended(problem)
        await process.wait()


def _kill(process: Process) -> None:
    with suppress(ProcessLookupError):
        process.kill()
