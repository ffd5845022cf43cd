"""`python -m tests.lies.table` tells all lies and writes docs/lies.md; it takes some ten minutes."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from tests.lies import devices, simulated
from tests.lies.lies import ALL, BOARD, DEVICES, LIES, ROS, SIMULATED, Lie
from tests.lies.scene import Result
from tests.lies.test_lies import mission, scene

PAGE = Path(__file__).parents[2] / "docs" / "lies.md"
HEAD = """# Wrong sensors

The robot drives at 0.5 m/s. Sensors begin to lie after 0.3 m, wheels and joints at the start. From then on, the table
counts the metres and seconds until the robot was really at rest. Then come the exit code of `btc run` and its reason,
which [the guard](guard.md) explains. `python -m tests.lies.table` writes this page.

If a lie is harmless or only hides a wall, the robot rightly continues: to its goal, or to the wall 1.5 m ahead.

| lie | platform | m | s | exit | reason |
|---|---|---|---|---|---|
"""


def row(lie: Lie, platform: str, result: Result) -> str:
    """A line of the table."""
    reason = result.reason.replace("|", "\\|")
    reason = f"`{reason}`" if reason else "none: the mission succeeded"
    figures = f"{result.way:.2f} | {result.seconds:.2f} | {int(bool(result.reason))}"
    return f"| {lie.name} | {platform} | {figures} | {reason} |\n"


def main() -> None:
    """Tells all lies."""
    from tests.ros.client import Client
    from tests.ros.declared import Peer
    from tests.ros.domains import free_domain
    from tests.ros.test_lies import LyingRobot

    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    rows: list[str] = []
    with free_domain() as domain, tempfile.TemporaryDirectory() as folder:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        peer = Peer("liar", domain=domain)
        peer.expect("ready")
        with closing(Client(domain)) as client:
            node = LyingRobot(peer, client, domain)
            tell: dict[str, Callable[[Lie], Result]] = {
                SIMULATED: lambda lie: simulated.run(mission(lie), [lie], **scene(lie)),
                DEVICES: lambda lie: devices.run(Path(folder, "d", lie.name), mission(lie), [lie], **scene(lie)),
                BOARD: lambda lie: devices.run(
                    Path(folder, "b", lie.name), mission(lie), [lie], board=True, **scene(lie)
                ),
                ROS: lambda lie: node.run(mission(lie), [lie.name], **scene(lie)),
            }
            for lie in LIES:
                for platform in ALL:
                    if platform in lie.platforms:
                        rows.append(row(lie, platform, tell[platform](lie)))
                        print(rows[-1], end="", file=sys.stderr)
        peer.close()
    PAGE.write_text(HEAD + "".join(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
