"""Figures for Prometheus, in its text format."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.server.links import RobotLink


def metrics(links: Iterable[RobotLink], clients: int) -> str:
    """Those of the robots, and how many sockets are open."""
    rows: list[tuple[str, str, str, float]] = []
    for link in links:
        known = link.latest
        rows.append(("btlang_robot_up", "Whether the robot is up.", link.name, float(link.is_up)))
        rows.append(
            ("btlang_robot_stopped", "Whether its emergency stop is shut.", link.name, bool(known.get("stopped")))
        )
        if known.get("battery") is not None:
            rows.append(("btlang_robot_battery_percent", "The charge of its battery.", link.name, known["battery"]))
        if link.seen is not None:
            rows.append(("btlang_robot_seen_seconds", "When it last said something.", link.name, link.seen))
    lines: list[str] = []
    for name, text, robot, value in sorted(rows):
        if not lines or name not in lines[-1]:
            lines += [f"# HELP {name} {text}", f"# TYPE {name} gauge"]
        lines.append(f'{name}{{robot="{robot}"}} {float(value):g}')
    lines += ["# HELP btlang_clients Open WebSockets.", "# TYPE btlang_clients gauge", f"btlang_clients {clients}"]
    return "\n".join(lines) + "\n"
