"""What the peers share: a node that is spun until standard input is closed, and lines that tell the test of events."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Generator
from types import coroutine

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

_LOOK = 0.01  # seconds between two looks at what waits


def tell(*words: object) -> None:
    """Prints a line that the test reads."""
    print(*words, flush=True)


@coroutine
def a_moment() -> Generator[None]:
    """Awaited where a callback waits, so that the others go on meanwhile: all of them run in one thread."""
    yield


async def pause(seconds: float) -> None:
    """Waits in a callback."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        await a_moment()


def serve(name: str, make: Callable[[Node], object]) -> None:
    """Spins a node with what `make` puts on it. Ends when the test closes the pipe, or dies."""
    rclpy.init()
    node = rclpy.create_node(name)
    kept = make(node)
    node.create_timer(_LOOK, lambda: None)  # what waits is looked at when anything happens
    # not rclpy's MultiThreadedExecutor: it stands still for a second now and then
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=_spin, args=(executor,))
    thread.start()
    tell("ready")
    sys.stdin.read()
    executor.shutdown()
    thread.join()
    del kept
    node.destroy_node()
    rclpy.shutdown()


def _spin(executor: SingleThreadedExecutor) -> None:
    try:
        executor.spin()
    except ExternalShutdownException:
        return
