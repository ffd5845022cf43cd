"""What other programs see of the ears of a ROS 2 robot, and how they answer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from std_msgs.msg import String

from tests.ros.client import LATCHED, Client
from tests.ros.processes import LONG, Command
from tests.ros.test_living_world import HALL

MISSION = 'ask "Tea or coffee?". if the answer is tea, say "Tea it is." then wait 1 second'


@pytest.mark.long
def test_a_recogniser_elsewhere_answers_a_question(
    tmp_path: Path, domain: int, client: Client, start_sim: Callable[..., Command], nav2: object, run_mission: object
) -> None:
    """It learns from /listening what to listen for, only as long as the question is open."""
    from btlang_interfaces.msg import Heard

    world = tmp_path / "hall.toml"
    world.write_text(HALL, encoding="utf-8")
    listening = client.hear(String, "/listening", LATCHED)
    start_sim("--world", str(world), "--speed", "4")
    folder = tmp_path / "run"
    folder.mkdir()
    given = ("--world", str(world), "--robot", "ros", "--sim-time", "--lines")
    mission = Command(folder, domain, "run", "-c", MISSION, *given)
    phrases = listening.wait(lambda message: message.data, 0).data.splitlines()
    assert "[i would like/want] [a/an/the/some] tea [please]" in phrases
    assert "*" not in phrases
    asked = len(listening.messages)
    client.publisher(Heard, "/heard").publish(Heard(text="I'd like some tea"))
    listening.wait(lambda message: not message.data, asked)
    assert mission.process.wait(LONG) == 0, mission.err
    assert 'says "Tea it is."' in " ".join(mission.out.split())
