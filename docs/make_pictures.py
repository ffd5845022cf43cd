"""Makes the pictures of README and docs: `python docs/make_pictures.py [FOLDER]`, by default into docs/pictures. With
`--page` it makes that of the page instead, in the browser of the tests.
"""

from __future__ import annotations

import re
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from btlang.cli import main

DOCS = Path(__file__).parent


def make_pictures(folder: Path) -> None:
    """Runs the mission of the README and draws its run and its tree, the guide of the museum, and the layers."""
    if any(find_spec(package) is None for package in ("matplotlib", "espeakng_loader", "av")):
        sys.exit(
            "The pictures of the guide need matplotlib and its voice. Install both: pip install '.[pictures,voice]'"
        )
    sys.path.insert(0, str(DOCS))
    from framework_figure import draw_layers
    from moving_picture import moving_picture

    readme = (DOCS.parent / "README.md").read_text(encoding="utf-8")
    found = re.search(r"```mission tea\.txt\n(.*?)```", readme, re.DOTALL)
    assert found is not None, "the README has no mission tea.txt"
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        mission = Path(temporary) / "tea.txt"
        mission.write_text(found[1], encoding="utf-8")
        run = ["run", str(mission), "--speed", "max", "--quiet", "--picture"]
        assert main([*run, str(folder / "tea_run.svg"), "--tree-picture", str(folder / "tea_tree_after_run.svg")]) == 0
        (folder / "tea.svg").write_bytes(moving_picture(mission))
    guide = DOCS.parent / "examples" / "guide"
    robot = ["--robot", str(guide / "robot.toml")]
    tour = ["run", str(guide / "missions" / "short_tour.txt"), *robot, "--speed", "max", "--quiet"]
    assert main([*tour, "--picture", str(folder / "guide_tour.gif")]) == 0
    assert main(["gesture", "picture", "bow", *robot, "-o", str(folder / "guide_bow.svg")]) == 0
    assert main(["world", str(guide / "world.toml"), "--picture", str(folder / "guide_museum.svg")]) == 0
    (folder / "framework.svg").write_bytes(draw_layers())


def make_page_picture(folder: Path) -> None:
    """Brings the guide up with its server, and takes a picture of its page; needs npm."""
    sys.path.insert(0, str(DOCS.parent))
    from tests.server.doors import PASSWORD
    from tests.web.packages import installed, node
    from tests.web.served import served

    scripts = DOCS.parent / "tests" / "web"
    with served("--robot", str(DOCS.parent / "examples" / "guide" / "robot.toml")) as address:
        picture = str(folder / "page_guide.png")
        node(scripts / "guide_picture.mjs", address, PASSWORD, picture, folder=installed(scripts))


if __name__ == "__main__":
    given = [word for word in sys.argv[1:] if word != "--page"]
    make = make_page_picture if "--page" in sys.argv else make_pictures
    make(Path(given[0]).absolute() if given else DOCS / "pictures")
