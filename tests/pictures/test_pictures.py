"""The files, as `btc` makes them."""

from __future__ import annotations

import importlib.util
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

import btlang
from btlang.cli import main
from btlang.pictures.track import PERSON, WALKED
from btlang.pictures.tree_picture import draw_tree
from tests.world.worlds import LIVELY

ROOT = Path(__file__).parent.parent.parent
SVG = "{http://www.w3.org/2000/svg}"


def btc(*arguments: object) -> int:
    return main([str(argument) for argument in arguments])


def run(mission: str, *arguments: object) -> int:
    return btc("run", "-c", mission, "--speed", "max", "--quiet", *arguments)


def size_of(path: Path) -> tuple[float, float]:
    root = ElementTree.parse(path).getroot()
    assert root.tag == f"{SVG}svg"
    return float(root.attrib["width"].removesuffix("pt")), float(root.attrib["height"].removesuffix("pt"))


def test_a_run_as_svg_and_png(tmp_path: Path) -> None:
    assert run("go to Alice then wave and say hello", "--picture", tmp_path / "a.svg") == 0
    assert run("go to Alice then wave and say hello", "--picture", tmp_path / "a.PNG") == 0
    width, height = size_of(tmp_path / "a.svg")
    title = ElementTree.parse(tmp_path / "a.svg").getroot().findtext(f"{SVG}title")
    assert title == "go to Alice then wave and say hello"
    with Image.open(tmp_path / "a.PNG") as image:
        assert image.info["Title"] == title
        image.load()
        assert image.format == "PNG"
        assert image.size == pytest.approx((2 * width, 2 * height), abs=2)


def test_a_run_as_gif(tmp_path: Path) -> None:
    path = tmp_path / "a.gif"
    assert (
        run("pick up the cup then go to the office and say 'on my way' then put down the cup", "--picture", path) == 0
    )
    with Image.open(path) as image:
        assert 100 < image.n_frames <= 150  # type: ignore[attr-defined]
        first = image.convert("RGB").tobytes()
        image.seek(image.n_frames - 1)  # type: ignore[attr-defined]
        assert image.convert("RGB").tobytes() != first
        assert image.info["loop"] == 0
    assert path.stat().st_size < 2_000_000


def test_people_on_pictures(tmp_path: Path) -> None:
    (tmp_path / "lively.toml").write_text(LIVELY)
    mission = 'ask Olga "Coffee?" then close the door then wait 9 s'
    options = ["--world", tmp_path / "lively.toml", "--seed", "3", "--record", tmp_path / "run.mcap"]
    for name in ("a.svg", "a.gif"):
        assert run(mission, *options, "--picture", tmp_path / name) == 0
    assert btc("replay", tmp_path / "run.mcap", "--lines", "--speed", "max", "--picture", tmp_path / "b.svg") == 0
    still = (tmp_path / "a.svg").read_bytes()
    assert WALKED.encode() in still
    assert len((tmp_path / "b.svg").read_bytes()) == pytest.approx(len(still), rel=0.1)
    wanted = [int(PERSON[at : at + 2], 16) for at in (1, 3, 5)]
    with Image.open(tmp_path / "a.gif") as image:
        counts = []
        for frame in range(image.n_frames):  # type: ignore[attr-defined]
            image.seek(frame)
            pixels = np.asarray(image.convert("RGB"), dtype=int)
            counts.append(int((abs(pixels - wanted).max(axis=2) < 12).sum()))
    assert counts[0] < max(counts) / 2  # nobody who walks is seen yet


def test_a_short_run_as_gif(tmp_path: Path) -> None:
    assert run("print hi", "--picture", tmp_path / "a.gif") == 0
    with Image.open(tmp_path / "a.gif") as image:
        assert image.n_frames >= 1  # type: ignore[attr-defined]


def test_a_failed_and_a_stopped_run_have_a_picture(tmp_path: Path) -> None:
    pictures = ["--picture", tmp_path / "a.svg", "--tree-picture", tmp_path / "tree.svg"]
    assert run("move forward 9 m", *pictures) == 1
    failed = (tmp_path / "a.svg").read_bytes(), (tmp_path / "tree.svg").read_bytes()
    assert run("move forward 9 m", *pictures, "--for", "3s") == 0
    stopped = (tmp_path / "a.svg").read_bytes(), (tmp_path / "tree.svg").read_bytes()
    assert all(one != other for one, other in zip(failed, stopped, strict=True))
    assert b"#c0440c" in failed[1]
    assert b"#c0440c" not in stopped[1]


def test_an_interrupted_run_has_a_picture(tmp_path: Path) -> None:
    log, picture = tmp_path / "log.jsonl", tmp_path / "a.svg"
    command = [sys.executable, "-m", "btlang", "run", "-c", "move forward 3 m", "--log", log, "--picture", picture]
    with subprocess.Popen(command, cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        while not log.exists() or "RUNNING" not in log.read_text(encoding="utf-8"):
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (130, ""), out
    size_of(picture)


def test_a_long_run_keeps_its_legend_short(tmp_path: Path) -> None:
    assert run("repeat (turn left 20 degrees then print hi)", "--for", "10min", "--picture", tmp_path / "a.svg") == 0
    _, height = size_of(tmp_path / "a.svg")
    assert height < 700


@pytest.mark.parametrize("mission", ["check bumped", "print '$x$ \u4f60 \udcff'", "wave"])
def test_a_robot_that_does_not_move(mission: str, tmp_path: Path) -> None:
    world = tmp_path / "empty.toml"
    world.write_text("start = { x = 1, y = 1 }\n", encoding="utf-8")
    for name in ("a.svg", "a.png", "a.gif"):
        run(mission, "--world", world, "--picture", tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000


def test_a_tree(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mission = "greet is wave then nod; greet then greet if the battery is low"
    assert btc("tree", "-c", mission, "--picture", tmp_path / "a.svg") == 0
    assert capsys.readouterr().out == f"Wrote {tmp_path / 'a.svg'}.\n"
    assert btc("tree", "-c", mission, "--picture", tmp_path / "b.svg", "--apart") == 0
    assert size_of(tmp_path / "a.svg") != size_of(tmp_path / "b.svg")
    assert btc("tree", "-c", mission, "--picture", tmp_path / "a.png") == 0
    width, height = size_of(tmp_path / "a.svg")
    with Image.open(tmp_path / "a.png") as image:
        assert image.size == pytest.approx((2 * width, 2 * height), abs=2), "one layout serves both"


def test_a_tree_after_a_run(tmp_path: Path) -> None:
    assert run("wave if bumped, otherwise nod", "--tree-picture", tmp_path / "a.svg") == 0
    drawn = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert all(colour in drawn for colour in ("#d3efe4", "#fbdccb", "#f6f7f8"))
    assert "#ffecb8" not in drawn


def test_a_tree_of_any_size_is_drawn(tmp_path: Path) -> None:
    tree = btlang.parse_tree(". ".join(["wave then nod and say hello"] * 300))
    draw_tree(tree.tree, tree.label, tree.is_action, str(tmp_path / "a.png"))
    with Image.open(tmp_path / "a.png") as image:
        assert max(image.size) < 33_000
        assert image.size[0] * image.size[1] < 40_000_000


def test_the_same_run_gives_the_same_file(tmp_path: Path) -> None:
    for name in ("a", "b"):
        pictures = ["--picture", tmp_path / f"{name}.svg", "--tree-picture", tmp_path / f"{name}.tree.svg"]
        assert run("go to the hall then wave", *pictures) == 0
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert (tmp_path / "a.tree.svg").read_bytes() == (tmp_path / "b.tree.svg").read_bytes()


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "-c", "wave", "--picture", "a.jpg"],
        ["run", "-c", "wave", "--picture", "svg"],
        ["run", "-c", "wave", "--tree-picture", "a.gif"],
        ["tree", "-c", "wave", "--picture", "a.gif"],
    ],
)
def test_a_wrong_ending_is_told_at_once(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    assert "expected a file that ends in .svg" in capsys.readouterr().err


def test_a_wrong_ending_in_the_library(tmp_path: Path) -> None:
    tree = btlang.parse_tree("wave")
    with pytest.raises(ValueError, match=r"ends in \.svg or \.png"):
        draw_tree(tree.tree, tree.label, tree.is_action, str(tmp_path / "a.pdf"))


@pytest.mark.parametrize("verb", [["run", "--speed", "max"], ["tree"]])
def test_a_file_that_cannot_be_written_is_told_first(
    verb: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "full.svg").symlink_to("/dev/full")
    (tmp_path / "folder.svg").mkdir()
    for name in ("no/a.svg", "folder.svg"):
        assert btc(*verb, "-c", "print hi", "--picture", tmp_path / name) == 2
        out, err = capsys.readouterr()
        assert "BT009" in err
        assert out == "", "the robot has not moved"
    assert btc(*verb, "-c", "print hi", "--picture", tmp_path / "full.svg") == 2
    assert "BT009" in capsys.readouterr().err


def test_a_mission_that_cannot_run_leaves_no_file(tmp_path: Path) -> None:
    words = tmp_path / "words.toml"
    words.write_text('[[action]]\nphrase = "hop"\nid = "Hop"\ncall = "no_such_module:hop"\n', encoding="utf-8")
    pictures = ["--picture", tmp_path / "a.svg", "--tree-picture", tmp_path / "b.svg"]
    assert run("hop", "--keywords", words, *pictures) == 2
    assert list(tmp_path.glob("*.svg")) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "-c", "wave", "--speed", "max", "--picture", "a.gif"],
        ["run", "-c", "wave", "--speed", "max", "--tree-picture", "a.png"],
        ["tree", "-c", "wave", "--picture", "a.png"],
    ],
)
def test_without_matplotlib(
    arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert btc(*arguments) == 2
    out, err = capsys.readouterr()
    assert "BT081" in err
    assert "pip install 'btlang[pictures]'" in err
    assert out == ""
    assert list(tmp_path.iterdir()) == []


def test_matplotlib_stays_silent_and_is_only_loaded_for_pictures(tmp_path: Path) -> None:
    script = (
        "import sys; from btlang.cli import main\n"
        "main(['tree', '-c', 'wave']); main(['run', '-c', 'wave', '--speed', 'max', '--quiet'])\n"
        f"main(['tree', '-c', 'wave', '--picture', {str(tmp_path / 'a.svg')!r}])\n"
        f"main(['run', '-c', 'wave', '--speed', 'max', '--quiet', '--picture', {str(tmp_path / 'a.svg')!r}])\n"
        f"main(['world', '--picture', {str(tmp_path / 'a.svg')!r}])\n"
        "assert 'matplotlib' not in sys.modules\n"
        f"main(['tree', '-c', 'wave', '--picture', {str(tmp_path / 'a.png')!r}])\n"
    )
    unwritable = tmp_path / "file"
    unwritable.write_text("no folder for a font cache", encoding="utf-8")
    environment = {"PATH": "", "PYTHONPATH": str(ROOT), "HOME": str(tmp_path), "MPLCONFIGDIR": str(unwritable)}
    done = subprocess.run([sys.executable, "-c", script], env=environment, text=True, capture_output=True, check=True)
    assert done.stderr == ""


def test_settings_of_the_user_do_not_matter(tmp_path: Path) -> None:
    import matplotlib

    run("wave", "--picture", tmp_path / "a.svg")
    with matplotlib.rc_context({"svg.fonttype": "none", "text.color": "red", "font.size": 30}):
        run("wave", "--picture", tmp_path / "b.svg")
        assert matplotlib.rcParams["font.size"] == 30
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_the_pictures_of_the_readme(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = importlib.util.spec_from_file_location("make_pictures", ROOT / "docs" / "make_pictures.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.make_pictures(tmp_path)
    sys.path.remove(str(ROOT / "docs"))
    made = sorted(path.name for path in tmp_path.iterdir())
    assert made == [
        "framework.svg", "guide_bow.svg", "guide_museum.svg", "guide_tour.gif",
        "tea.svg", "tea_run.svg", "tea_tree_after_run.svg",
    ]  # fmt: skip
    for name in (name for name in made if name.endswith(".svg")):
        size_of(tmp_path / name)
    assert (tmp_path / "framework.svg").read_bytes() == (ROOT / "docs" / "pictures" / "framework.svg").read_bytes()
    moving = (tmp_path / "tea.svg").read_text(encoding="utf-8")
    assert 10_000 < len(moving) < 300_000
    timings = re.findall(r'values="([^"]*)" keyTimes="([^"]*)" calcMode="(\w+)"', moving)
    assert len(timings) > 100
    for values, key_times, mode in timings:  # browsers ignore an animation whose times are wrong
        times = [float(time) for time in key_times.split(";")]
        assert times == sorted(times)
        assert len(times) == values.count(";") + 1
        assert (times[0], mode == "discrete" or times[-1]) == (0.0, True)
        assert times[-1] <= 1


def test_the_modules_of_the_framework_exist(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    figure = importlib.import_module("framework_figure")
    modules = [name for *_, names, _ in figure.LAYERS for name in names] + [*figure.STOP]
    assert [name for name in modules if not (ROOT / "btlang" / name).exists()] == []
