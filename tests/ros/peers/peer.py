"""What the peers share: a node that is spun until standard input is closed, and lines that tell the test of events."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


def tell(*words: object) -> None:
    """Prints a line that the test reads."""
    print(*words, flush=True)


def serve(name: str, make: Callable[[Node], object]) -> None:
    """Spins a node with what `make` puts on it. Ends when the test closes the pipe, or dies."""
    rclpy.init()
    node = rclpy.create_node(name)
    kept = make(node)
    executor = MultiThreadedExecutor(4)
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


def _spin(executor: MultiThreadedExecutor) -> None:
    try:
        executor.spin()
    except ExternalShutdownException:
        return
