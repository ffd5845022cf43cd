"""Folders with several programs: which trees and models belong together, and what models leave open."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.projects.trees import TREE, problems, write

MOVE = '<Action ID="Move"><input_port name="to" type="double"/></Action>'
WAREHOUSE = Path(__file__).parent / "warehouse"


def test_programs_of_a_folder_may_define_one_id(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each means its own tree, also where it includes a file that both share."""
    shared = '<include path="shared.xml"/>'
    write(tmp_path, "shared.xml", TREE.format("Rest", "<Wave/>"))
    for name in ("one", "two"):
        use = TREE.format(
            f"Main {name}".replace(" ", ""), '<Sequence><SubTree ID="Dock"/><SubTree ID="Rest"/></Sequence>'
        )
        write(tmp_path, f"{name}.xml", shared, use, TREE.format("Dock", "<Nod/>"))
    assert problems(capsys, str(tmp_path)) == []


@pytest.mark.parametrize("joined", ["include", "project", "use", "main tree"])
def test_a_program_defines_an_id_once(joined: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one, two = TREE.format("Dock", "<Nod/>"), TREE.format("Dock", "<Wave/>")
    write(tmp_path, "one.xml", '<include path="two.xml"/>' if joined == "include" else "", one)
    write(tmp_path, "two.xml", two)
    if joined == "project":
        write(tmp_path, "all.btproj", '<include path="one.xml"/><include path="two.xml"/>')
    elif joined == "use":
        write(tmp_path, "three.xml", TREE.format("Main", '<SubTree ID="Dock"/>'))
    elif joined == "main tree":
        write(tmp_path, "three.xml", TREE.format("Rest", "<Wave/>"), attributes='main_tree_to_execute="Dock"')
    found = problems(capsys, str(tmp_path))
    assert [problem["code"] for problem in found if problem["severity"] == "error"] == ["BT127"]


def test_a_use_means_the_nearest_tree_and_model(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The packages of a repository have trees and models of the same IDs."""
    for package, port in (("arm", "pose"), ("base", "place")):
        model = f'<Action ID="Move"><input_port name="{port}" type="double"/></Action>'
        write(tmp_path, f"{package}/nodes.xml", models=model)
        write(tmp_path, f"{package}/trees/part.xml", TREE.format("Dock", f'<Move {port}="1"/>'))
        write(tmp_path, f"{package}/trees/main.xml", TREE.format("MainTree", '<SubTree ID="Dock"/>'))
    assert problems(capsys, str(tmp_path)) == []
    write(tmp_path, "arm/trees/part.xml", TREE.format("Dock", '<Move pose="up"/>'))
    assert [problem["code"] for problem in problems(capsys, str(tmp_path))] == ["BT233"]


@pytest.mark.parametrize(
    ("installs", "found"),
    [
        ("install(FILES trees/main.xml library/dock.xml DESTINATION share)", []),
        (
            'install(DIRECTORY\n  trees/main.xml  # start\n  "${CMAKE_CURRENT_SOURCE_DIR}/library" DESTINATION x)',
            [],
        ),
        ("install(DIRECTORY trees library DESTINATION share)", ["BT235"]),
        ("install(FILES ${TREES} library/dock.xml DESTINATION share)", ["BT235"]),
        ("# install(FILES trees/main.xml library/dock.xml DESTINATION share)", ["BT235"]),
    ],
)
def test_what_a_package_installs_belongs_together(
    installs: str, found: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A tree that the package leaves out is in a folder that is nearer, but isn't meant."""
    (tmp_path / "CMakeLists.txt").write_text(installs, "utf-8")
    use = '<Sequence><SetBlackboard output_key="p" value="1"/><SubTree ID="Dock" pose="{p}"/></Sequence>'
    write(tmp_path, "trees/main.xml", TREE.format("MainTree", use))
    write(tmp_path, "trees/old/dock.xml", TREE.format("Dock", "<Nod/>"))
    write(tmp_path, "library/dock.xml", TREE.format("Dock", '<Move to="{pose}"/>'), models=MOVE)
    assert [problem["code"] for problem in problems(capsys, str(tmp_path)) if problem["code"] != "BT236"] == found


def test_ports_of_nav2_that_may_be_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Nav2's own models have no defaults for them, and neither have copies in the repositories of teams."""
    ports = {
        "Wait": ("wait_duration", "server_name", "server_timeout"),
        "GoalUpdated": ("goal", "goals"),
        "GetCurrentPose": ("global_frame", "robot_base_frame"),
        "FollowPath": ("path", "controller_id"),
    }
    listed = {node: "".join(f'<input_port name="{name}"/>' for name in names) for node, names in ports.items()}
    models = "".join(f'<Action ID="{node}">{inner}</Action>' for node, inner in listed.items())
    tree = '<Sequence><Wait wait_duration="1"/><GoalUpdated/><GetCurrentPose/><FollowPath/></Sequence>'
    write(tmp_path, "tree.xml", TREE.format("MainTree", tree), models=models)
    found = [problem["message"] for problem in problems(capsys, str(tmp_path))]
    assert found == ["The port path of FollowPath is missing."]


def test_an_installed_file_is_the_one_in_its_package(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path, "src/dock_trees/trees/dock.xml", TREE.format("Dock", "<Nod/>"))
    for name, include in (
        ("one", 'path="install/dock_trees/share/dock_trees/trees/dock.xml"'),
        ("two", 'ros_pkg="dock_trees" path="trees/dock.xml"'),
    ):
        use = TREE.format("MainTree", '<SubTree ID="Dock"/>')
        write(tmp_path, f"src/robot/{name}.xml", f"<include {include}/>", use)
    assert problems(capsys, str(tmp_path)) == []
    write(tmp_path, "src/robot/one.xml", '<include path="install/dock_trees/share/dock_trees/trees/none.xml"/>')
    assert [problem["code"] for problem in problems(capsys, str(tmp_path))] == ["BT128"]


def test_a_model_that_is_out_of_date_is_one_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = '<input_port name="speed"/>', '<input_port name="speed"/><input_port name="lane"/>'
    model = '<Action ID="Drive">{}</Action>'
    use = '<Drive speed="1" lane="2" gear="3"/>'
    write(tmp_path, "a.xml", TREE.format("A", f"<Sequence>{use * 2}</Sequence>"), models=model.format(old))
    write(tmp_path, "b.xml", TREE.format("B", '<Drive speed="1" lane="2"/>'), models=model.format(new))
    [problem] = problems(capsys, str(tmp_path))
    assert (problem["code"], Path(problem["file"]).name) == ("BT239", "a.xml")
    assert "'lane', 'gear'" in problem["message"]
    assert [Path(note["file"]).name for note in problem["notes"]] == ["a.xml", "a.xml", "b.xml"]
    # a port that is misspelt as often as it is written stays a mistake of the nodes
    use = '<Drive sped="1"/>'
    write(tmp_path, "a.xml", TREE.format("A", f"<Sequence>{use * 2}</Sequence>"), models=model.format(old))
    assert {problem["code"] for problem in problems(capsys, str(tmp_path))} == {"BT232"}


def test_ports_that_are_left_out_are_optional(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = '<Action ID="Drive"><input_port name="speed"/><input_port name="lane"/></Action>'
    uses = '<Drive speed="1"/><Drive speed="1"/><Drive lane="2"/>'
    write(tmp_path, "a.xml", TREE.format("A", f"<Sequence>{uses}</Sequence>"), models=model)
    assert [problem["message"] for problem in problems(capsys, str(tmp_path))] == [
        "The port speed of Drive is missing."
    ]


def test_a_file_of_models_may_be_empty(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Tools make such files for models to come."""
    write(tmp_path, "nodes.xml", "<TreeNodesModel><!-- to come --></TreeNodesModel>")
    assert problems(capsys, str(tmp_path)) == []
    write(tmp_path, "nodes.xml", "")
    assert [problem["code"] for problem in problems(capsys, str(tmp_path))] == ["BT122"]


def test_the_planted_faults_of_a_repository_are_found_and_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    """A warehouse robot: programs that share libraries, a stale palette, C++ sources, Nav2's nodes."""
    planted = (WAREHOUSE / "faults.txt").read_text(encoding="utf-8").splitlines()
    found = [
        f"{Path(problem['file']).relative_to(WAREHOUSE).as_posix()}:{problem['line']} {problem['code']}"
        for problem in problems(capsys, str(WAREHOUSE))
    ]
    assert found == [line.partition("  ")[0] for line in planted]


def test_a_tree_may_be_in_a_file_that_cannot_be_included(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Only the include is reported; misspelt trees of this file, and unknown ones of other programs, still are."""
    uses = '<Sequence><SubTree ID="Gone"/><SubTree ID="Prat"/></Sequence>'
    write(tmp_path, "main.xml", '<include path="gone.xml"/>', TREE.format("Main", uses), TREE.format("Part", "<Nod/>"))
    write(tmp_path, "other.xml", TREE.format("Other", '<SubTree ID="Nowhere"/>'))
    found = {problem["code"]: problem["message"] for problem in problems(capsys, str(tmp_path))}
    assert found.keys() - {"BT236"} == {"BT128", "BT126", "BT244"}
    assert "'Prat'" in found["BT126"]
    assert "'Nowhere'" in found["BT244"]


def test_what_colcon_has_built_is_not_checked_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A workspace has copies of the trees in `build` and `install`."""
    for folder in ("src", "build", "install"):
        write(tmp_path, f"{folder}/docks/main.xml", TREE.format("Main", '<SubTree ID="Gone"/>'))
        if folder != "src":
            (tmp_path / folder / "COLCON_IGNORE").touch()
    [problem] = [each for each in problems(capsys, str(tmp_path)) if each["code"] == "BT126"]
    assert problem["file"] == str(tmp_path / "src" / "docks" / "main.xml")
    assert problems(capsys, str(tmp_path / "install")) != []  # if that is asked for
