"""Pages about trees: what they show of a project, that they stay the same, and that no text from outside is markup."""

from __future__ import annotations

import re
import shutil
from html.parser import HTMLParser
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

from btlang.cli import main
from btlang.documents.pages import block, code, escape_markdown, file_name
from btlang.documents.project import KeyReader
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.tree.node import Node
from tests.conftest import matches_golden
from tests.corpus.test_team import TEAM

HERE = Path(__file__).parent
_OWN = {"a", "h1", "h2", "h3", "p", "ul", "li", "table", "thead", "tbody", "tr", "th", "td", "pre", "code", "img"}


class Tags(HTMLParser):
    """The tags of a page, with what they refer to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        html = MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"]).render(text)
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))

    @property
    def targets(self) -> set[str]:
        return {str(told.get("href") or told.get("src")) for _, told in self.found if "href" in told or "src" in told}


def documented(out: Path, *paths: Path) -> dict[str, str]:
    """The files that are written, by their names."""
    assert main(["compile", *map(str, paths), "--to", "markdown", "-o", str(out)]) == 0
    return {path.name: path.read_text(encoding="utf-8") for path in out.iterdir()}


def test_a_project_is_described(tmp_path: Path) -> None:
    shutil.copytree(HERE / "project", tmp_path / "project")
    made = documented(tmp_path / "docs", tmp_path / "project")
    assert sorted(name for name in made if name.endswith(".md")) == [
        "deliver.xml.md", "index.md", "nodes.xml.md", "parts-doors.xml.md", "wave_twice.txt.md",
    ]  # fmt: skip
    for name in ("deliver.xml.md", "index.md", "parts-doors.xml.md", "wave_twice.txt.md", "nodes.xml.md"):
        matches_golden(re.sub(r"(```text\n).*?(```)", r"\1...\n\2", made[name], flags=re.DOTALL), HERE / "pages" / name)
    for name in made:
        for target in Tags(made[name]).targets if name.endswith(".md") else ():
            page, _, place = target.partition("#")
            assert not page or page in made, target
            assert not place or f'<a id="{place}"></a>' in made[page or name], target
    again = documented(tmp_path / "again", tmp_path / "project")
    assert again == made


def test_text_from_outside_is_no_markup(tmp_path: Path) -> None:
    made = documented(tmp_path / "docs", HERE / "hostile.xml")
    assert all(re.fullmatch(r"[\w.-]+", name) for name in made)
    assert len({name.lower() for name in made}) == len(made) == 7
    for name in ("hostile.xml.md", "index.md"):
        page = Tags(made[name])
        assert {tag for tag, _ in page.found} <= _OWN
        assert all(target.startswith(("#tree-", "hostile.xml.")) for target in page.targets)
        assert not any(key.startswith("on") for _, told in page.found for key in told)
        shown = re.sub("^```+text.*?^```+$", "", made[name], flags=re.MULTILINE | re.DOTALL)
        assert not re.search(r"https?://|www\.|a@evil|\u202e", shown)


def test_one_file_is_one_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = str(TEAM / "groot2_greenhouse.xml")
    assert main(["compile", file, "--to", "markdown"]) == 0
    shown = capsys.readouterr().out
    assert "## TendRow" in shown
    assert main(["compile", file, "-o", str(tmp_path / "page.md")]) == 0
    assert (tmp_path / "page.md").read_text(encoding="utf-8") == shown
    assert main(["compile", "-c", "wave", "--to", "markdown"]) == 0
    assert "```text\nwave\n```" in capsys.readouterr().out


def test_a_page_of_somebody_else_stays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "index.md").write_text("mine\n")
    assert main(["compile", str(TEAM), "--to", "markdown", "-o", str(tmp_path)]) == 2
    assert "error BT009" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["index.md"]


def test_what_can_not_be_read_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "broken.xml").write_text('<root BTCPP_format="4"><BehaviorTree')
    (tmp_path / "package.xml").write_text("<package/>")
    (tmp_path / "notes.txt").write_text("These are notes.\n")
    assert main(["compile", str(tmp_path), "--to", "markdown", "-o", str(tmp_path / "docs")]) == 2
    assert "broken.xml:1:" in capsys.readouterr().err
    (tmp_path / "broken.xml").unlink()
    assert main(["compile", str(tmp_path), "--to", "markdown", "-o", str(tmp_path / "docs")]) == 2
    assert "there are no trees in XML and no missions in it that can be read" in capsys.readouterr().err
    assert not (tmp_path / "docs").exists()
    (tmp_path / "wave.txt").write_text("wave\n")
    made = documented(tmp_path / "docs", tmp_path)
    assert "- notes.txt" in made["index.md"]
    for words in (["--to", "markdown"], ["-o", str(tmp_path / "one.md")], ["--to", "json"]):
        with pytest.raises(SystemExit):
            main(["compile", str(tmp_path), str(TEAM), *words])


@pytest.mark.parametrize("text", ["`", "``a`", "a|b", " x ", "", "\n", "```"])
def test_code_is_shown_as_it_is(text: str) -> None:
    html = MarkdownIt("commonmark").render(code(text)).replace("\\|", "|")
    assert f"<code>{' '.join(text.split()) or ' '}</code>" in html


def test_marks_are_escaped() -> None:
    assert escape_markdown("a*b\n<c>") == "a\\*b \\<c\\>"
    assert (escape_markdown("1. x"), escape_markdown("- x"), escape_markdown("2 x")) == ("1\\. x", "\\- x", "2 x")
    assert next(block("a\n````\n")) == "`````text"
    assert file_name("../a b/é.xml") == "a-b-.xml"


def test_keys_are_read_and_set() -> None:
    leaves = (
        Node("Script", ports=(("code", "a := b + 1; c += 'd'"),)),
        Node("SetBlackboard", ports=(("value", "{v}"), ("output_key", "k"))),
        Node("ComputePathToPose", ports=(("goal", "{goal}"), ("path", "{path}"), ("_skipIf", "stop"), ("_uid", "{u}"))),
        Node("LoopString", ports=(("queue", "{q}"), ("value", "{=}"))),
    )  # fmt: skip
    keys = KeyReader({}, world_vocabulary()).keys(Node("Sequence", leaves))
    assert {key: " ".join(sorted(uses)) for key, uses in keys.items()} == {
        "a": "sets", "b": "reads", "c": "reads sets", "v": "reads", "k": "sets", "goal": "reads", "path": "sets",
        "stop": "reads", "q": "reads", "value": "sets",
    }  # fmt: skip
