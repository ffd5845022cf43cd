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

A sensor begins to lie after the robot has driven 0.3 m at 0.5 m/s; wheels and joints lie from the start. The table has
the metres and seconds from then until the robot was really at rest, the exit code of `btc run`, and the reason that it
gave. [The guard](guard.md) explains the reasons. `python -m tests.lies.table` writes this page.

Where the lie only hides a wall or is harmless, the robot rightly drives on: to the wall, 1.5 m ahead, or to its goal.

| lie | told by | m | s | exit | reason |
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
