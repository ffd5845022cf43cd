"""`btc serve-actions` in processes of its own: any ROS 2 program calls its actions, and missions run on them."""

from __future__ import annotations

import json
import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from action_msgs.msg import GoalStatus
from nav_msgs.msg import Odometry
from std_srvs.srv import Trigger

import btlang
from btlang.cli import main
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.vocabulary.shipped import DEFAULT_WORLD
from tests.profiles import only_long
from tests.ros.client import Client, Goal, answer
from tests.ros.processes import LONG, REPOSITORY, Command, wait_until

FAR = {"distance": "3 m", "speed": "0.2 meters per second"}
LONG_WAY = "move forward 3 meters at 0.2 meters per second"
KILLED = str(Path(__file__).parent / "peers" / "profile.xml")
"""With which a process that was killed is missed after two seconds."""
WORDS = """
[[action]]
phrase = "count to {number}"
id = "CountTo"
call = "serving_words:Count"
slots = { number = "count" }
"""
PYTHON = """
class Count:
    def __init__(self, robot, progress):
        self.robot, self.progress = robot, progress

    def start(self, number):
        self.number, self.at = number, 0

    def tick(self):
        self.at += 1
        self.progress(self.at / self.number, f"says {self.at}")
        return True if self.at == self.number else None

    def halt(self):
        self.robot.print("never mind")
"""

TABLE = """
[[action]]
phrase = "tell {text}"
id = "Tell"
ros = { phrase = "say {text}", name = "/actions/say" }
"""


SHORT_WAYS = {
    "start = { x = 1.5, y = 1.5, facing = 0 }": "start = { x = 2.0, y = 5.4, facing = 90 }",
    'name = "lobby", x = 3.0, y = 1.5': 'name = "lobby", x = 2.0, y = 5.4',
}
"""What is changed in the world that ships, so that a mission is over sooner."""


@pytest.fixture
def serve(tmp_path: Path, domain: int, run_mission: object) -> Iterator[Callable[..., Command]]:
    """Starts `btc serve-actions` in a process of its own; it has to end as asked, and to complain of nothing."""
    started: list[Command] = []

    def start(*options: str, ready: bool = True, **environment: str | None) -> Command:
        folder = tmp_path / f"server{len(started)}"
        folder.mkdir()
        command = Command(folder, domain, "serve-actions", *options, **environment)
        started.append(command)
        if ready:
            command.wait_for("ready")
        return command

    yield start
    codes = [command.end() for command in started]
    assert set(codes) <= {130, 143, -signal.SIGKILL}
    assert [command.err for command in started] == [""] * len(started)


def phrase(client: Client, action: str, phrase: str = "", **values: str) -> Goal:
    """A goal of RunPhrase, which is accepted."""
    from btlang_interfaces.action import RunPhrase

    request = RunPhrase.Goal(phrase=phrase, names=list(values), values=list(values.values()))
    goal = Goal(client, client.action(RunPhrase, action), request)
    assert goal.accepted
    return goal


def end_of(goal: Goal) -> tuple[int, bool, str]:
    end = goal.result()
    return end.status, end.result.success, end.result.reason


def test_goals_of_a_program_that_knows_rclpy_alone(serve, client: Client, tmp_path: Path):
    (tmp_path / "words.toml").write_text(WORDS, encoding="utf-8")
    (tmp_path / "serving_words.py").write_text(PYTHON, encoding="utf-8")
    server = serve("--keywords", str(tmp_path / "words.toml"), "--speed", "5")
    drive = phrase(client, "/actions/move_forward", "MoveForward", distance="1 m")
    assert end_of(drive) == (GoalStatus.STATUS_SUCCEEDED, True, "")
    shares = [message.progress for message in drive.feedback.messages]
    assert shares == sorted(shares)
    assert len(shares) > 3
    assert drive.feedback.messages[0].state == "move forward 1 m"
    own = phrase(client, "/actions/count_to", "count to {number}", number="twenty")  # a class of the user
    assert end_of(own) == (GoalStatus.STATUS_SUCCEEDED, True, "")
    assert own.feedback.messages[-1].state.startswith("says")
    aborted = GoalStatus.STATUS_ABORTED
    wrong = phrase(client, "/actions/move_forward", distance="two cats")
    assert end_of(wrong) == (aborted, False, "distance is 'two cats', which isn't a length, such as 5 m")
    wrong = phrase(client, "/actions/go_to", "fly to {place}", place="lab")
    reason = (
        "'fly to {place}' isn't served here: this is GoTo, with the phrase 'go to {place} [through {via}] [{manner}]'"
    )
    assert end_of(wrong) == (aborted, False, reason)
    failed = phrase(client, "/actions/move_forward", distance="50 m")
    status, _, reason = end_of(failed)
    assert status == aborted
    assert reason.startswith("stopped after")
    server.wait_for("failed move forward 50 m: stopped")


def test_cancelled_half_way_the_robot_stands(start_sim, serve, client: Client):
    start_sim("--speed", "1", "--namespace", "anna")  # at 2 its patience ends within 2.5 s of a busy machine
    serve("--robot", "ros", "--sim-time", "--only", "motion", "speech", "--namespace", "anna")
    odometry = client.hear(Odometry, "/anna/odom")
    start = odometry.next().pose.pose.position.y
    goal = phrase(client, "/anna/actions/move_forward", distance="1.5 m", speed="0.1 m/s")
    odometry.wait(lambda message: message.pose.pose.position.y > start + 0.3)
    second = phrase(client, "/anna/actions/turn_left", angle="90")
    assert end_of(second)[2] == "'move forward 1.5 m at 0.1 m/s' is using the base"
    assert goal.cancel()
    assert end_of(goal) == (GoalStatus.STATUS_CANCELED, False, "it was cancelled")
    still = odometry.next()
    assert abs(still.twist.twist.linear.x) < 1e-3
    assert still.pose.pose.position.y < start + 1.4
    turned = phrase(client, "/anna/actions/turn_left", angle="0.25 turns")
    assert end_of(turned) == (GoalStatus.STATUS_SUCCEEDED, True, "")


def test_a_signal_and_an_emergency_stop(serve, client: Client):
    server = serve("--name", "mover")
    goal = phrase(client, "/actions/move_forward", **FAR)
    goal.feedback.wait()
    assert client.call(Trigger, "/mover/stop").success
    assert end_of(goal) == (GoalStatus.STATUS_ABORTED, False, "emergency stop")
    goal = phrase(client, "/actions/move_forward", **FAR)  # it goes on
    goal.feedback.wait()
    result = goal.ending()
    goal.feedback.next()  # the server knows by now who asks
    assert server.end(signal.SIGTERM) == 143
    assert answer(result).result.reason == "the server was stopped"


def commands(log: Path) -> Counter[tuple[str, str]]:
    """How often each action ended how. Their order may differ where two run at the same time."""
    entries = world_vocabulary().entries
    lines = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    ended = [(line["id"], line["status"]) for line in lines if line.get("status") in ("SUCCESS", "FAILURE")]
    return Counter((node_id, status) for node_id, status in ended if node_id in entries)


@only_long
def test_two_servers_do_a_mission_that_ships(start_sim, serve, tmp_path: Path, domain: int, nav2: object, capsys):
    """It has a condition too, which is looked at where the mission runs. The lobby is near the kitchen."""
    path = str(REPOSITORY / "examples" / "tea_service.txt")
    text = Path(DEFAULT_WORLD).read_text(encoding="utf-8")
    for far, near in SHORT_WAYS.items():
        assert far in text
        text = text.replace(far, near)
    (tmp_path / "world.toml").write_text(text, encoding="utf-8")
    world = ("--world", str(tmp_path / "world.toml"))
    built_in, over_ros = tmp_path / "built_in.json", tmp_path / "over_ros.json"
    assert main(["run", path, *world, "--speed", "max", "--quiet", "--log", str(built_in)]) == 0
    capsys.readouterr()
    start_sim(*world, "--speed", "4")
    options = (*world, "--robot", "ros", "--sim-time", "--only")
    talker = serve("--name", "talker", *options, "speech", "gestures", ready=False)
    mover = serve("--name", "mover", *options, "navigation", "manipulation")
    talker.wait_for("ready")
    rest = ("--robot", "actions", "--sim-time", "--log", str(over_ros))
    mission = Command(tmp_path, domain, "run", path, *world, *rest)
    assert mission.process.wait(4 * LONG) == 0, mission.out + mission.err
    assert commands(over_ros) == commands(built_in)
    assert ("done   say" in talker.out, "done   say" in mover.out) == (True, False)
    assert ("done   go to Alice" in talker.out, "done   go to Alice" in mover.out) == (False, True)


def test_a_server_is_missing_halted_and_killed(serve, tmp_path: Path, domain: int):
    profile = {"FASTRTPS_DEFAULT_PROFILES_FILE": KILLED}
    talker = serve("--only", "speech", **profile, ready=False)
    mover = serve("--only", "motion", "--name", "mover", **profile)

    def run(name: str, text: str, *options: str) -> Command:
        (tmp_path / name).mkdir()
        return Command(tmp_path / name, domain, "run", "-c", text, "--robot", "actions", *options, **profile)

    lacking = run("lacking", "move forward 10 cm then wave")
    words = tmp_path / "words.toml"
    words.write_text(TABLE, encoding="utf-8")
    told = run("told", "tell hello", "--keywords", str(words))
    assert told.process.wait(LONG) == 0, told.err
    talker.wait_for("done   say hello")

    halted = run("halted", LONG_WAY)
    mover.wait_for("start  move forward")
    assert halted.end(signal.SIGINT) == 130
    mover.wait_for("halted move forward")
    assert lacking.process.wait(LONG) == 2
    assert "'wave' needs the action /actions/wave, but there is no action server /actions/wave." in lacking.err

    going = run("going", f"{LONG_WAY}, otherwise say sorry")
    wait_until(lambda: mover.out.count("start  move forward") == 2, "the way")
    mover.process.send_signal(signal.SIGKILL)
    assert going.process.wait(LONG) == 0, going.err
    assert "the server of /actions/move_forward is gone" in going.out
    assert "done   say sorry" in going.out


def test_a_server_that_freezes(serve, domain: int, monkeypatch: pytest.MonkeyPatch):
    """It is alive for DDS, and says nothing more."""
    monkeypatch.setattr("btlang.ros.words.servers.SILENCE", 3.0)
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    mover = serve("--only", "motion")

    def freeze(event: object) -> None:
        if "start  move forward" in mover.out:
            mover.process.send_signal(signal.SIGSTOP)

    try:
        outcome = btlang.parse_tree(LONG_WAY).run(robot="actions", sinks=[freeze])
    finally:
        mover.process.send_signal(signal.SIGCONT)
    assert outcome.failure.reason == "/actions/move_forward sends no feedback on the goal"


def test_without_its_interfaces(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setitem(sys.modules, "btlang_interfaces", None)
    assert main(["serve-actions"]) == 2
    assert "python -m btlang.ros.interfaces --own" in capsys.readouterr().err
    assert main(["run", "-c", "wave", "--robot", "actions"]) == 2
    assert "python -m btlang.ros.interfaces --own" in capsys.readouterr().err


def test_an_action_that_cannot_run(run_mission: object, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    (tmp_path / "words.toml").write_text(WORDS.replace("serving_words", "no_such_words"), encoding="utf-8")
    assert main(["serve-actions", "--keywords", str(tmp_path / "words.toml")]) == 2
    assert "error BT080: The command 'CountTo' can't run: no_such_words:Count cannot be" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options",
    [
        ["serve-actions", "--sim-time"],
        ["serve-actions", "--robot", "ros", "--speed", "2"],
        ["serve-actions", "--only", "dancing"],
        ["run", "-c", "wave", "--servers", "/anna/actions"],
        ["run", "-c", "wave", "--robot", "actions", "--speed", "2"],
    ],
)
def test_wrong_options(options: list[str], capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as caught:
        main(options)
    assert caught.value.code == 2
    assert f"Run 'btc help {options[0]}'" in capsys.readouterr().err
