"""`python -m btlang.ros.bridge`: see the package."""

from __future__ import annotations

import json
import os
import signal
import sys
from contextlib import suppress
from typing import BinaryIO

from btlang.diagnostics.diagnostic import MissionError
from btlang.ros.available import require_ros
from btlang.ros.clocks import wait_until

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST = 1000  # lines that wait for ROS
_ENDING = 2.0  # seconds for goals to be cancelled


def main() -> int:
    """Run the bridge until standard input or SIGTERM ends it; return the exit code."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # which a terminal sends to the server, too
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print is no answer
    try:
        _run(sys.stdin.buffer, output)
    except MissionError as error:
        _write(output, {"problem": str(error)}, "")
        return 2
    return 0


def _run(lines: BinaryIO, output: BinaryIO) -> None:
    """Serve clients until standard input ends. Raises MissionError (BT100) without ROS 2."""
    require_ros()
    from btlang.ros.bridge.bridge import Bridge
    from btlang.ros.node import ExecutorThread, SpunNode

    with SpunNode(f"btlang_bridge_{os.getpid()}") as spun:
        thread = ExecutorThread(spun.node)
        bridge = Bridge(spun.node, lambda about, text: _write(output, about, text))
        try:
            for line in lines:
                thread.post(lambda line=line: bridge.take(line))  # type: ignore[misc]
                if thread.left > _MOST:
                    wait_until(lambda: thread.left < _MOST, float("inf"))
        finally:
            thread.post(bridge.close)
            wait_until(lambda: not (thread.left or bridge.left()), _ENDING)


def _write(output: BinaryIO, about: dict[str, Any], text: str) -> None:
    with suppress(OSError):  # the server is gone: standard input says so, too
        output.write(f"{json.dumps(about)}\t{text}\n".encode())
        output.flush()


if __name__ == "__main__":
    sys.exit(main())
