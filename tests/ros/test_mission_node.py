"""Any ROS 2 program sends a sentence to `btc ros-node` and gets a running tree; the clients here know rclpy alone."""

from __future__ import annotations

import json
import signal
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from action_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs.srv import GetState
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.qos import QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

from btlang.api import parse_tree
from btlang.cli import main
from tests.ros.client import LATCHED, Client, Goal, answer
from tests.ros.processes import LONG, Command

FAR = "move forward 3 meters at 0.2 meters per second"


def mission(client: Client, run_mission: Any, text: str, **fields: Any) -> Goal:
    """A mission that was sent."""
    return Goal(client, client.action(run_mission, "/btlang/run_mission"), run_mission.Goal(mission=text, **fields))


@pytest.mark.parametrize("form", ["english", "xml"])
def test_a_mission_runs(form: str, start_node, client: Client, run_mission: Any):
    """A sentence, and the same tree in XML."""
    start_node("--speed", "10")
    sentence = "move forward 1 meter then say done"
    goal = mission(client, run_mission, sentence if form == "english" else str(parse_tree(sentence).to("xml")))
    assert goal.accepted
    end = goal.result()
    assert end.status == GoalStatus.STATUS_SUCCEEDED
    assert (end.result.success, end.result.outcome, end.result.reason) == (True, "success", "")
    assert 2 < end.result.seconds < 6
    news = [message for message in goal.feedback.messages if message.paths]
    assert [message.running for message in news] == ["move forward 1 m", "say done", ""]
    assert (list(news[-1].paths), list(news[-1].statuses)) == (["/1", "/"], [1, 1])
    assert [message.time for message in news] == sorted(message.time for message in news)


def test_what_it_tells_on_topics(start_node, client: Client, run_mission: Any):
    from btlang_interfaces.msg import TreeStatus

    start_node("--speed", "10")
    log = client.hear(String, "/btlang/log")
    health = client.hear(DiagnosticArray, "/diagnostics")
    health.wait(lambda array: array.status[0].message == "no mission has run yet")
    goal = mission(client, run_mission, "say hello then go to the moon")
    assert goal.result().status == GoalStatus.STATUS_ABORTED
    mission(client, run_mission, "say hello").result()
    tree = json.loads(client.hear(String, "/btlang/tree", LATCHED).wait().data)  # whoever comes later hears it too
    assert (tree["outline"], tree["statuses"]) == ("Say: say hello", {"/": "SUCCESS"})
    assert tree["nodes"] == [{"path": "/", "id": "Say", "words": "say hello", "ports": {"text": "hello"}}]
    status = client.hear(TreeStatus, "/btlang/status", LATCHED).wait()
    assert (list(status.paths), list(status.statuses)) == (["/"], [TreeStatus.SUCCESS])
    log.wait(lambda line: line.data.startswith("task 1: the mission succeeded after"))
    assert any('says   "hello"' in line.data for line in log.messages)
    found = health.wait(lambda array: array.status[0].message.startswith("the mission succeeded"))
    assert found.status[0].name == "btlang: mission"


def test_who_joins_late_knows_the_statuses(start_node, client: Client, run_mission: Any):
    """A snapshot and the changes after it give what one gets who was there from the start."""
    start_node("--speed", "5")
    changes = client.hear(String, "/btlang/tree_changes")
    goal = mission(client, run_mission, "repeat 4 times: wave then nod")
    changes.wait()
    late = client.hear(String, "/btlang/tree", LATCHED)
    snapshot = json.loads(late.wait().data)
    goal.result()
    last = json.loads(late.wait(lambda message: json.loads(message.data)["statuses"].get("/") == "SUCCESS").data)
    known, sequence = dict(snapshot["statuses"]), snapshot["sequence"]
    for change in map(json.loads, [message.data for message in changes.messages]):
        if change["sequence"] > sequence:
            assert change["sequence"] == sequence + 1
            sequence = change["sequence"]
            known |= change["changes"]
    assert (known["/"], sequence) == ("SUCCESS", last["sequence"])
    assert known == last["statuses"]


def test_missions_are_recorded(start_node, client: Client, run_mission: Any, tmp_path: Path, capsys):
    start_node("--speed", "10", "--record", str(tmp_path / "kept"))
    assert mission(client, run_mission, "wave then nod").result().result.success
    assert not mission(client, run_mission, "wave then fail").result().result.success
    files = sorted((tmp_path / "kept").iterdir())
    assert len(files) == 2
    told = []
    for file in files:
        assert main(["why", str(file)]) == 0
        told.append(capsys.readouterr().out)
    assert any("The mission succeeded" in text for text in told)
    assert any("The mission failed" in text for text in told)


def test_why_it_fails(start_node, client: Client, run_mission: Any):
    node = start_node("--speed", "10")
    wrong = mission(client, run_mission, "move forwarrd 1 meter").result()
    assert wrong.status == GoalStatus.STATUS_ABORTED
    assert (wrong.result.success, wrong.result.outcome) == (False, "failure")
    assert "mission:1:1: error BT010" in wrong.result.reason
    absent = mission(client, run_mission, "wave", keywords=["nowhere.toml"]).result()
    assert "nowhere.toml" in absent.result.reason
    failed = mission(client, run_mission, "move forward 100 meters").result()
    assert failed.result.outcome == "failure"
    assert "move forward 100 meters" in failed.result.reason
    assert node.err == ""


def test_missions_queue(start_node, client: Client, run_mission: Any):
    """One at a time, the most urgent first; each goal hears what its task waits for."""
    from btlang_interfaces.msg import Tasks

    start_node()
    tasks = client.hear(Tasks, "/btlang/tasks", LATCHED)
    first = mission(client, run_mission, "wait 1 minute")
    first.feedback.wait(lambda news: news.state == "underway")
    second = mission(client, run_mission, "wait 0.1 seconds")
    waiting = second.feedback.wait(lambda news: news.state == "queued")
    assert (waiting.task, waiting.waits) == (2, "task 1 comes first")
    third = mission(client, run_mission, "say hello", priority=-1)
    queue = tasks.wait(lambda message: len(message.tasks) == 3)
    assert [(task.id, task.state) for task in queue.tasks] == [(1, "underway"), (2, "queued"), (3, "queued")]
    assert (queue.tasks[2].mission, queue.tasks[2].priority, queue.tasks[2].person) == ("say hello", -1, "ROS 2")
    assert third.cancel()
    ended = third.result()
    assert (ended.status, ended.result.outcome) == (GoalStatus.STATUS_CANCELED, "stopped")
    assert first.cancel()
    assert first.result().status == GoalStatus.STATUS_CANCELED
    result = second.result().result
    assert (result.success, result.task) == (True, 2)
    assert not tasks.wait(lambda message: not message.tasks).hindrance


def test_many_goals_at_once(start_node, client: Client, run_mission: Any):
    """By default services of ROS 2 lose all but ten, and so do their clients."""
    start_node("--speed", "10")
    client.action(run_mission, "/btlang/run_mission")  # which waits until it is found
    many = QoSProfile(depth=1000)
    depths = {f"{name}_service_qos_profile": many for name in ("goal", "result", "cancel")}
    server = ActionClient(client.node, run_mission, "/btlang/run_mission", **depths)
    assert server.wait_for_server(LONG)
    time.sleep(0.2)  # and until it has found this one, too
    goal = run_mission.Goal(mission="say hello")
    sent: list[Any] = []
    answer(client.node.executor.create_task(lambda: sent.extend(server.send_goal_async(goal) for _ in range(60))))
    handles = [answer(future) for future in sent]
    assert all(handle.accepted for handle in handles)
    ends = [answer(client.begin(handle.get_result_async)).result for handle in handles]
    assert [end.outcome for end in ends] == ["success"] * 60


def test_an_urgent_mission_suspends_another(start_node, client: Client, run_mission: Any):
    start_node("--speed", "10")
    usual = mission(client, run_mission, 'set n to 0\nrepeat 3 times: wait 5 s then increase n\nprint "{n} times"')
    usual.feedback.wait(lambda news: news.time > 1)
    urgent = mission(client, run_mission, "wave", priority=5)
    assert urgent.result().result.success
    assert usual.result().result.success
    states = [news.state for news in usual.feedback.messages]
    assert {"underway", "delayed"} <= {*states}
    assert states[-1] == "underway"


def test_cancelled_half_way_over_ros(start_sim, start_node, client: Client, run_mission: Any, nav2: Any):
    start_sim("--speed", "2")
    start_node("--robot", "ros", "--sim-time")
    odometry = client.hear(Odometry, "/odom")
    done = mission(client, run_mission, "move forward 1 meter then say done").result()
    assert done.result.success, done.result.reason
    start = odometry.next().pose.pose.position.y
    assert start == pytest.approx(3.0, abs=0.1)
    goal = mission(client, run_mission, "turn around then move forward 2 meters")
    goal.feedback.wait(lambda news: news.running == "move forward 2 m")
    odometry.wait(lambda message: message.pose.pose.position.y < start - 0.5)
    assert goal.cancel()
    end = goal.result()
    still = odometry.next()
    assert (end.status, end.result.outcome) == (GoalStatus.STATUS_CANCELED, "stopped")
    assert abs(still.twist.twist.linear.x) < 1e-3
    time.sleep(0.3)
    assert odometry.next().pose.pose.position.y == pytest.approx(still.pose.pose.position.y, abs=1e-3)
    assert still.pose.pose.position.y > start - 1.5


def test_emergency_stop(start_node, client: Client, run_mission: Any):
    start_node()
    goal = mission(client, run_mission, FAR)
    goal.feedback.wait()
    began = time.monotonic()
    assert client.call(Trigger, "/btlang/stop").success
    assert time.monotonic() - began < 1
    end = goal.result()
    assert end.status == GoalStatus.STATUS_ABORTED
    assert (end.result.outcome, end.result.reason) == ("stopped", "emergency stop by ROS 2")
    assert client.call(Trigger, "/btlang/stop").success  # nothing runs
    goal = mission(client, run_mission, "move forward 10 centimeters then say on")
    assert goal.feedback.wait().waits == "the robot is stopped: emergency stop by ROS 2"
    assert client.call(Trigger, "/btlang/release").success
    assert goal.result().result.success


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_a_mission(start_node, client: Client, run_mission: Any, number: signal.Signals, code: int):
    node: Command = start_node()
    goal = mission(client, run_mission, FAR)
    goal.feedback.wait()
    result = goal.ending()
    client.call(GetState, "/btlang/get_state")  # by its answer the node knows who asks for the result
    assert node.end(number) == code
    assert answer(result).result.outcome == "stopped"
    assert node.err == ""


def test_without_its_interfaces(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setitem(sys.modules, "btlang_interfaces", None)
    assert main(["ros-node"]) == 2
    assert "python -m btlang.ros.interfaces --own" in capsys.readouterr().err


@pytest.mark.parametrize("options", [["--sim-time"], ["--robot", "ros", "--speed", "2"], ["--name", "a-b"]])
def test_wrong_options(options: list[str], capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as caught:
        main(["ros-node", *options])
    assert caught.value.code == 2
    assert "Run 'btc help ros-node'" in capsys.readouterr().err


def test_what_others_send_reads_no_files_and_runs_no_python(
    start_node, client: Client, run_mission: Any, tmp_path: Path
):
    (tmp_path / "hop.py").write_text("def hop():\n    open('hopped', 'w').close()\n")
    (tmp_path / "hop.toml").write_text('[[action]]\nphrase = "hop"\nid = "Hop"\ncall = "hop:hop"\n')
    (tmp_path / "secret.txt").write_text("xyzzy\n")
    words = [str(tmp_path / "hop.toml")]
    start_node("--speed", "10")
    included = mission(client, run_mission, f'include "{tmp_path}/secret.txt"\nwave').result().result
    assert "files can't be included here" in included.reason
    assert "--allow-keywords" in mission(client, run_mission, "hop", keywords=words).result().result.reason
    assert "--allow-keywords" in mission(client, run_mission, "hop", keywords=["/dev/zero"]).result().result.reason


def test_what_the_node_allows(start_node, client: Client, run_mission: Any, tmp_path: Path):
    (tmp_path / "hop.py").write_text("def hop():\n    return True\n")
    (tmp_path / "hop.toml").write_text('[[action]]\nphrase = "hop"\nid = "Hop"\ncall = "hop:hop"\n')
    (tmp_path / "secret.txt").write_text("xyzzy\n")
    (tmp_path / "dances.txt").write_text("dance is nod\n")
    start_node("--speed", "10", "--allow-keywords", str(tmp_path), "--include-root", str(tmp_path))
    words = [str(tmp_path / "hop.toml")]
    assert mission(client, run_mission, 'include "dances.txt"\ndance then hop', keywords=words).result().result.success
    wrong = mission(client, run_mission, 'include "secret.txt"\nwave').result().result
    assert "secret.txt:1:1: error BT010" in wrong.reason
    assert "xyzzy" not in wrong.reason
