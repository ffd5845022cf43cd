"""`include` brings the definitions, facts and values of another mission."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.frontends.mission.completion.completer import completions
from btlang.repl.draft import MissionDraft
from btlang.tree.dump import plain
from btlang.vocabulary.load import load_vocabulary


def written(folder: Path, **texts: str) -> str:
    """Writes missions; the path of the one called main."""
    for name, text in texts.items():
        path = folder / f"{name.replace('__', '/')}.txt"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return str(folder / "main.txt")


def tree_of(path: str) -> list[str]:
    trees = {plain(btlang.parse_tree(read_source(path), parser=parser).tree) for parser in ("shunting-yard", "lark")}
    assert len(trees) == 1
    return trees.pop().splitlines()


def problems(path: str) -> list[str]:
    with pytest.raises(MissionError) as error:
        btlang.parse_tree(read_source(path))
    return [f"{Path(problem.span.place).name} {problem.code}" for problem in error.value.diagnostics]


def test_names_places_and_conditions_come_from_files_beside_the_mission(tmp_path: Path) -> None:
    main_file = written(
        tmp_path,
        main='include "parts/all.txt"\nif tired, greet Alice, otherwise go to the stove',
        parts__all='include "more.txt"\ntired means the battery is low\nwave',
        parts__more="stove is at (1, 2)\ngreet {x} is wave at {x}",
    )
    assert tree_of(main_file)[:4] == [
        "IfThenElse",
        "  SubTree ID=tired",
        '  SubTree ID="greet {x}" x=Alice',
        "  GoTo place=stove",
    ]


def test_a_file_is_read_once_and_a_later_definition_wins(tmp_path: Path) -> None:
    main_file = written(
        tmp_path,
        main='include "one.txt"\ninclude "two.txt"\ndance is nod\ndance',
        one='include "base.txt"',
        two='include "base.txt"',
        base="dance is wave",
    )
    assert tree_of(main_file) == ["SubTree ID=dance", "BehaviorTree ID=dance", "  Nod"]
    tree = btlang.parse_tree(read_source(main_file))
    assert [(warning.code, warning.span.text) for warning in tree.warnings] == [("BT017", "dance")]


def test_all_errors_come_at_once_with_their_files(tmp_path: Path) -> None:
    main_file = written(
        tmp_path, main='include "part.txt"\ninclude "none.txt"\ndance then flarp', part="dance is wave tehn nod"
    )
    assert problems(main_file) == ["main.txt:2:1 BT001", "main.txt:3:12 BT010", "part.txt:1:15 BT010"]


def test_circles_and_endless_depth_end(tmp_path: Path) -> None:
    circle = written(tmp_path, main='include "a.txt"\nwave', a='include "b.txt"', b='include "a.txt"')
    assert problems(circle) == ["b.txt:1:1 BT046"]
    texts = {f"m{i}": f'include "m{i + 1}.txt"' for i in range(80)}
    assert problems(written(tmp_path, main='include "m0.txt"\nwave', m80="x is wave", **texts)) == ["m49.txt:1:1 BT001"]


def test_a_folder_and_other_bytes_are_told(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "bytes.txt").write_bytes(b"dance is \xff\xfe")
    main_file = written(tmp_path, main='include "folder"\ninclude "bytes.txt"\nwave')
    assert problems(main_file) == ["bytes.txt:1:10 BT002", "main.txt:1:1 BT001"]


def test_format_and_explain_keep_the_include(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main_file = written(tmp_path, main='include   "part.txt"\ndance', part="dance is wave")
    assert main(["format", main_file]) == 0
    assert Path(main_file).read_text() == 'include "part.txt"\ndance\n'
    capsys.readouterr()
    assert main(["explain", main_file]) == 0
    assert 'read as: include "part.txt"' in capsys.readouterr().out


def test_completion_and_the_repl_know_the_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, part="dance {n} is nod {n} times\nstove is at (1, 2)")
    line = 'include "part.txt"\n'
    assert "dance " in {option.text for option in completions(line + "da", load_vocabulary())}
    assert "stove" in {option.text for option in completions(line + "go to the ", load_vocabulary())}
    session = MissionDraft()
    session.add(session.compile(line.strip()).entry)
    assert plain(session.compile("dance 3").mission.tree).startswith('SubTree ID="dance {n}" n=3')
