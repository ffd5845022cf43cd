"""Seconds as messages of ROS 2."""

from __future__ import annotations

from typing import Any

from builtin_interfaces.msg import Duration, Time


def duration(seconds: float) -> Duration:
    """builtin_interfaces/Duration."""
    whole, part = _parts(seconds)
    return Duration(sec=whole, nanosec=part)


def stamp(seconds: float) -> Time:
    """builtin_interfaces/Time."""
    whole, part = _parts(seconds)
    return Time(sec=whole, nanosec=part)


def seconds_of(message: Any) -> float:
    """A Time or a Duration in seconds."""
    return float(message.sec + message.nanosec * 1e-9)


def _parts(seconds: float) -> tuple[int, int]:
    return divmod(round(seconds * 1e9), 10**9)
