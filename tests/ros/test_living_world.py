"""People, questions, zones, doors and switches between `btc sim-ros` and missions on a ROS 2 robot."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from std_msgs.msg import Bool
from std_srvs.srv import Empty, SetBool

from tests.conftest import without_overruns
from tests.ros.client import LATCHED, Client
from tests.ros.processes import LONG, Command

HALL = """
start = { x = 1.5, y = 2.0, facing = 0 }
walls = [[[0, 0], [10, 0], [10, 4], [0, 4], [0, 0]], [[5, 0], [5, 1.5]], [[5, 2.7], [5, 4]]]
places = [{ name = "lab", x = 8, y = 2 }, { name = "landing", x = 3.5, y = 0.8 }]
objects = [{ name = "lamp", x = 6, y = 3, switch = "off" }, { name = "cup", x = 3, y = 2.2, known = false }]
doors = [{ name = "lab door", from = [5, 1.5], to = [5, 2.7], open = false }]

[[zones]]
name = "stairs"
kind = "slow"
speed = 0.3
points = [[3, 0.3], [4, 0.3], [4, 1.2], [3, 1.2]]

[[people]]
name = "Alice"
x = 3
y = 3
comes = 12
answers = { coffee = "Sure, thanks!" }
"""
VISIT = """
wait until the robot sees Alice
ask Alice "Would you like some coffee?"
if the answer is yes, say "Coffee!"
take a picture of Alice
pick up the cup then give the cup to Alice
go to the cup, otherwise come back
avoid the stairs
go to the landing, otherwise say "Not there."
open the lab door
check that the lab door is open
switch on the lamp
check that the lamp is on
call the staff saying "All done."
"""


CARPET = """
[[zones]]
name = "carpet"
kind = "slow"
speed = 0.3
points = [[2, 1], [3, 1], [3, 2.8], [2, 2.8]]
"""
WALKER = """
[[people]]
name = "Bob"
x = 4
y = 3.4
speed = 0.3
walks = [[2.5, 3.4], [4.2, 3.4]]
again = true
"""
CALLER = """
[[people]]
name = "Carl"
x = 3
y = 1.5
says = [{ at = 60, text = "Help!" }]
"""


class Hall:
    """`btc sim-ros` in the hall, and missions there."""

    def __init__(self, folder: Path, domain: int, start_sim: Callable[..., Command]) -> None:
        self._folder, self._domain, self._start = folder, domain, start_sim
        self._file = folder / "hall.toml"
        self._count = 0

    def open(self, more: str = "", speed: int = 4) -> Command:
        self.change(more)
        return self._start("--world", str(self._file), "--speed", str(speed))

    def change(self, more: str) -> None:
        """The next mission has another world than the robot."""
        self._file.write_text(HALL + more, encoding="utf-8")

    def run(self, mission: str, *options: str) -> tuple[int, str, str]:
        """The exit code, the output and the errors."""
        folder = self._folder / f"run{self._count}"
        folder.mkdir()
        self._count += 1
        given = ("--world", str(self._file), "--robot", "ros", "--sim-time", "--lines", *options)
        command = Command(folder, self._domain, "run", "-c", mission, *given)
        code = command.process.wait(3 * LONG)
        assert "Traceback" not in command.out + command.err
        return code, command.out, command.err


@pytest.fixture
def hall(tmp_path: Path, domain: int, start_sim: Callable[..., Command], nav2: object, run_mission: object) -> Hall:
    return Hall(tmp_path, domain, start_sim)


def told(out: str) -> list[str]:
    """The lines without their times, but for commands that begin or succeed."""
    lines = [line.split(maxsplit=1)[1] for line in without_overruns(out).splitlines() if line[:1] == " "]
    return [" ".join(line.split()) for line in lines if not line.startswith(("start", "done"))]


def test_a_visit(hall: Hall) -> None:
    sim = hall.open()
    code, out, err = hall.run(VISIT)
    assert code == 0, err + out
    assert [line for line in told(out) if not line.startswith(("sees cup", "navigates", "arrives"))] == [
        "sees Alice",
        'says "Would you like some coffee?"',
        'asks Alice: "Would you like some coffee?"',
        'hears "Sure, thanks!" from Alice',
        'says "Coffee!"',
        "picture Alice, cup",
        "gives cup to Alice",
        "failed approach cup: Alice has the cup",
        "failed go to landing: the landing is in the stairs, where the robot may not go",
        'says "Not there."',
        "door lab door open",
        "switch lamp on",
        'calls "All done."',
    ]
    sim.wait_for('calls "All done."')


@pytest.mark.long
def test_a_plan_into_a_zone_that_the_robot_does_not_know(hall: Hall) -> None:
    hall.open()
    hall.change('[[zones]]\nname = "strip"\nkind = "keep out"\npoints = [[2, 0], [2.4, 0], [2.4, 4], [2, 4]]\n')
    code, out, err = hall.run("go to (3, 2.8), otherwise go to (1.2, 2)")
    assert code == 0, err
    assert "the way to (3.00, 2.80) leads through the strip, where the robot may not go" in out
    code, out, err = hall.run("move backward 2 m, otherwise move forward 10 cm")
    assert code == 0, err
    assert "the strip is in the way, where the robot may not go" in out


@pytest.mark.long
def test_a_mission_closes_a_zone_and_the_robot_goes_around(hall: Hall) -> None:
    hall.open(CARPET, speed=4)
    code, out, err = hall.run("avoid the carpet. go to (4, 2), otherwise say no. if the robot sees the cup, say cup")
    assert code == 0, err
    assert "failed" not in out, out
    code, out, err = hall.run("avoid the carpet. go to (2.5, 2), otherwise say no. open the carpet. go to (2.5, 2)")
    assert code == 0, err
    assert "failed go to (2.5, 2): (2.50, 2.00) is in the carpet, where the robot may not go" in " ".join(out.split())


@pytest.mark.long
def test_who_walks_is_followed_with_new_goals(hall: Hall) -> None:
    hall.open(WALKER, speed=4)
    code, out, err = hall.run("wait until the robot sees Bob then go to Bob then check that someone is nearby")
    assert code == 0, err + out
    assert out.count("sees   Bob") == 1


@pytest.mark.long
def test_nobody_is_found_who_was_not_seen(hall: Hall) -> None:
    hall.open()
    code, out, _ = hall.run("go to Alice, otherwise say one")
    assert code == 0
    assert "failed go to Alice: I haven't seen Alice" in " ".join(out.split())


@pytest.mark.long
def test_the_preflight_knows_ears_and_eyes(hall: Hall) -> None:
    hall.change("")
    code, out, _ = hall.run("listen for yes or no then check that the robot sees someone", "--preflight")
    assert code == 1
    assert "/heard" in out
    assert "/sightings" in out
    hall.open()
    code, out, _ = hall.run("listen for yes or no then check that the robot sees someone", "--preflight")
    assert (code, out.splitlines()[-1]) == (0, "The robot has everything that the mission needs.")


class WithoutInterfaces(Command):
    """`btc` where btlang's interfaces are not compiled."""

    program = (
        "-c",
        "import sys; sys.modules['btlang_interfaces'] = None; from btlang.__main__ import main; sys.exit(main())",
    )


@pytest.mark.long
def test_without_interfaces_it_does_all_the_rest(tmp_path: Path, domain: int, nav2: object) -> None:
    for name in ("sim", "drive", "listen"):
        (tmp_path / name).mkdir()
    world = tmp_path / "hall.toml"
    world.write_text(HALL, encoding="utf-8")
    given = ("--world", str(world))
    sim = WithoutInterfaces(tmp_path / "sim", domain, "sim-ros", *given, "--speed", "4")
    sim.wait_for("ready")
    options = ("--robot", "ros", "--sim-time", "--lines", *given)
    mission = "open the lab door then check that the lab door is open"
    drive = WithoutInterfaces(tmp_path / "drive", domain, "run", "-c", mission, *options)
    assert drive.process.wait(2 * LONG) == 0, drive.err
    listen = WithoutInterfaces(tmp_path / "listen", domain, "run", "-c", "listen for hello", *options)
    assert listen.process.wait(2 * LONG) == 2
    assert "BT110" in listen.err
    assert sim.end() == 130
    assert sim.err.startswith("btlang sim-ros: no /heard, /asking, /sightings, /follow and /hand_over: ")


@pytest.mark.long
def test_what_other_programs_see(hall: Hall, client: Client) -> None:
    from btlang_interfaces.msg import Heard, Question, Sightings
    from btlang_interfaces.srv import Follow, HandOver

    heard, seen = client.hear(Heard, "/heard"), client.hear(Sightings, "/sightings")
    lamp = client.hear(Bool, "/switches/lamp/state", LATCHED)
    door = client.hear(Bool, "/doors/lab_door/state", LATCHED)
    hall.open(CALLER)
    assert (lamp.wait().data, door.wait().data) == (False, False)
    caller = heard.wait(lambda message: message.text == "Help!", 0)
    assert caller.who == "Carl"
    named = seen.wait(lambda message: "Alice" in [each.name for each in message.sightings])
    alice = next(each for each in named.sightings if each.name == "Alice")
    assert (alice.kind, alice.position.x, alice.position.y) == ("person", 3.0, 3.0)
    asking = client.node.create_publisher(Question, "/asking", LATCHED)
    asking.publish(Question(who="Alice", text="Coffee?"))
    assert heard.wait(lambda message: message.who == "Alice", 0).text == "Sure, thanks!"
    assert client.call(Follow, "/follow", person="Alice", follow=True).success
    refused = client.call(Follow, "/follow", person="Nobody", follow=True)
    assert (refused.success, refused.message) == (False, "I don't know where 'Nobody' is")
    far = client.call(SetBool, "/doors/lab_door", data=True)
    assert not far.success
    assert far.message.startswith("the lab door is 3.")
    assert not client.call(SetBool, "/switches/lamp", data=True).success
    empty = client.call(HandOver, "/hand_over", hand="left", person="Alice")
    assert (empty.success, empty.message) == (False, "the left hand is empty")


@pytest.mark.long
def test_who_goes_slowly_and_who_has_lost_its_place(hall: Hall, client: Client) -> None:
    from nav2_msgs.msg import SpeedLimit

    limits, asked = client.hear(SpeedLimit, "/speed_limit"), []

    def localize(request: Empty.Request, response: Empty.Response) -> Empty.Response:
        asked.append(request)
        return response

    client.node.create_service(Empty, "/reinitialize_global_localization", localize)
    hall.open()
    code, out, err = hall.run("go slowly to (2.2, 2) then localize")
    assert code == 0, err + out
    assert len(asked) == 1
    told = [(each.percentage, each.speed_limit) for each in limits.messages]
    assert told[0] == (True, 50.0)
    assert told[-1] == (False, 0.0)
