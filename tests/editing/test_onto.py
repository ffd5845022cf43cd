"""`btc compile --onto` and `btc edit --editor`, as a user types them."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from btlang.cli import main

TREE = b"""\xef\xbb\xbf<?xml version="1.0"?>\r
<root BTCPP_format="4">\r
    <BehaviorTree ID="MainTree" _description="says hello">\r
        <Sequence> <!-- first -->\r
            <Say   text='hello'/> <!-- loudly -->\r
            <Open_Door door="{door}"></Open_Door>\r
        </Sequence>\r
    </BehaviorTree>\r
    <!-- the end -->\r
</root>\r
"""


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file, in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "tree.xml"
    path.write_bytes(TREE)
    return path


def test_an_edit_changes_what_was_edited(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    english = tree.with_suffix(".txt")
    assert main(["compile", "tree.xml", "-o", "tree.txt"]) == 0
    english.write_text(english.read_text().replace("# loudly", "# softly").replace("hello", "good-bye"))
    assert main(["compile", "tree.txt", "--onto", "tree.xml", "-o", "other.xml"]) == 0
    changed = TREE.replace(b"loudly", b"softly").replace(b"'hello'", b"'good-bye'")
    assert (tree.with_name("other.xml").read_bytes(), tree.read_bytes()) == (changed, TREE)
    for _ in range(2):  # the text knows what it was written onto
        assert main(["compile", "tree.txt", "--onto", "tree.xml"]) == 0
        assert tree.read_bytes() == changed
    tree.write_bytes(changed.replace(b"the end", b"END"))
    assert main(["compile", "tree.txt", "--onto", "tree.xml"]) == 2
    assert "BT136" in capsys.readouterr().err
    assert tree.read_bytes() == changed.replace(b"the end", b"END")
    assert main(["compile", "tree.txt", "--onto", "tree.xml", "--force"]) == 0
    assert tree.read_bytes() == changed


@pytest.mark.parametrize(
    ("content", "code"),
    [(b"wave\n", "BT120"), (b"<root/>", "BT122"), (b"<root><BehaviorTree>", "BT120"), (b"", "BT120")],
)
def test_what_is_no_tree_stays(tree: Path, content: bytes, code: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Also where the mission was made from the file when it was one."""
    assert main(["compile", "tree.xml", "-o", "tree.txt"]) == 0
    tree.write_bytes(content)
    for mission in (["-c", "wave"], ["tree.txt"]):
        assert main(["compile", *mission, "--onto", "tree.xml"]) == 2
        assert code in capsys.readouterr().err
        assert tree.read_bytes() == content


def test_the_editor_of_the_user(
    tree: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def editor(program: str) -> None:
        script = tree.with_name("editor.py")
        script.write_text(f"import pathlib, sys\npath = pathlib.Path(sys.argv[1])\n{program}\n")
        monkeypatch.setenv("VISUAL", f"'{sys.executable}' '{script}'")

    editor("path.write_text(path.read_text().replace('hello', 'hi'))")
    assert main(["edit", "--editor", "tree.xml"]) == 0
    changed = TREE.replace(b"'hello'", b"'hi'")
    assert tree.read_bytes() == changed
    editor("pass")
    assert main(["edit", "--editor", "tree.xml"]) == 0
    assert capsys.readouterr().out.endswith("tree.xml stays as it is.\n")
    text = b"nonsense here"
    for program, code in ((f"path.write_bytes({text})", 2), (f"path.write_bytes({text}); sys.exit(1)", 1),
                          ("path.write_bytes(b'\\xff')", 2)):  # fmt: skip
        editor(program)
        assert main(["edit", "--editor", "tree.xml"]) == code
        told = capsys.readouterr()
        kept = Path(told.out.partition("tree.xml stays as it is. Your text is in ")[2].strip().removesuffix("."))
        assert kept.read_bytes() in (text, b"\xff")
        assert ("BT0" in told.err) == (code == 2)
    editor("path.unlink(); import os; os.mkfifo(path)")
    assert main(["edit", "--editor", "tree.xml"]) == 1
    for command in ("no-such-editor", '"unclosed'):
        monkeypatch.setenv("VISUAL", command)
        with pytest.raises(SystemExit):
            main(["edit", "--editor", "tree.xml"])
        assert "can't be started" in capsys.readouterr().err
    assert tree.read_bytes() == changed


def test_a_file_that_the_mission_was_not_made_from_stays(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = tree.with_name("other one.xml")
    other.write_text('<root BTCPP_format="4"><BehaviorTree ID="Other"><Nod/></BehaviorTree></root>')
    assert main(["compile", str(other), "-o", "other.txt"]) == 0
    tree.with_name("hand.txt").write_text("wave")
    text = tree.with_name("other.txt").read_text()
    tree.with_name("damaged.txt").write_text(text.replace('digest="', "digest="))
    for mission, reason in (
        ("other.txt", "it was made from other one.xml"),
        ("hand.txt", "it doesn't say which file it was made from"),
        ("damaged.txt", "it doesn't say which file it was made from"),
    ):
        assert main(["compile", mission, "--onto", "tree.xml"]) == 2
        told = capsys.readouterr().err
        assert f"error BT136: This mission can't be written onto tree.xml: {reason}." in told
        assert f"or write it anyway: btc compile {mission} --onto tree.xml --force" in told
        assert tree.read_bytes() == TREE
    with pytest.raises(SystemExit):
        main(["compile", "other.txt", "--onto", "tree.xml", "--dialect", "3"])
    os.mkfifo("pipe.xml")
    assert main(["compile", "hand.txt", "--onto", "pipe.xml"]) == 2
    assert "BT009" in capsys.readouterr().err


def test_a_tree_that_only_other_files_use_is_no_warning(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main_tree, part = (f'<BehaviorTree ID="{name}"><Wave/></BehaviorTree>' for name in ("Main", "Part"))
    text = f'<root BTCPP_format="4" main_tree_to_execute="Main">{main_tree}{part}</root>'
    tree.write_text(text, "utf-8")
    mission = tree.with_suffix(".txt")
    assert main(["compile", str(tree), "-o", str(mission)]) == 0
    assert "BT051" not in capsys.readouterr().err
    assert main(["compile", str(mission), "--onto", str(tree)]) == 0
    assert capsys.readouterr() == ("", "")
    assert tree.read_text("utf-8") == text


def test_the_main_tree_may_stand_in_an_included_file(tree: Path) -> None:
    english = tree.with_suffix(".txt")
    tree.with_name("inner.xml").write_text('<root><BehaviorTree ID="Inner"><SubTree ID="Greet"/></BehaviorTree></root>')
    head = '<root main_tree_to_execute="Inner">\n <include path="inner.xml"/>\n'
    text = f'{head} <BehaviorTree ID="Greet"><Wave/></BehaviorTree>\n</root>'
    tree.write_text(text)
    assert main(["compile", "tree.xml", "-o", "tree.txt"]) == 0
    assert main(["compile", "tree.txt", "--onto", "tree.xml"]) == 0
    assert tree.read_text() == text
    english.write_text(english.read_text().replace("wave", "nod"))
    assert main(["compile", "tree.txt", "--onto", "tree.xml"]) == 0
    assert tree.read_text() == text.replace("Wave", "Nod")


@pytest.mark.parametrize(("leaf", "new"), [('<Action ID="Nod"/>', '<Action ID="Wave"/>'), ("<Nod/>", "<Wave/>")])
@pytest.mark.parametrize("root", ["<root>", '<root BTCPP_format="4">'])
def test_new_leaves_are_written_as_the_others_are(root: str, leaf: str, new: str, tree: Path) -> None:
    lines = (
        root,
        '<BehaviorTree ID="MainTree">',
        "<Sequence>",
        f"{leaf}{{}}",
        "</Sequence>",
        "</BehaviorTree>",
        "</root>",
    )
    text = "\n".join(lines)
    tree.write_text(text.format(""))
    assert main(["compile", "-c", "nod then wave", "--onto", "tree.xml", "--force"]) == 0
    assert tree.read_text() == text.format(f"\n{new}")
