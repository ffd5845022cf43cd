"""Whether ROS 2 is there. Imports none of it, so that it can be asked anywhere."""

from __future__ import annotations

from importlib import import_module

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.text.source import Source, Span


def require_ros(*packages: str) -> None:
    """Raises MissionError (BT100) where rclpy, or one of the message packages named, cannot be imported."""
    for package in ("rclpy", *packages):
        try:
            import_module(package)
        except ImportError as error:
            absent = error.name is not None and error.name.partition(".")[0] == package
            reason = f"there is no Python package {package}" if absent else str(error)
            raise MissionError([diagnostic("BT100", Span(Source("", "ROS 2"), 0, 0), reason=reason)]) from None
