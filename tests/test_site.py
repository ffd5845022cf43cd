"""The site of docs/: which files it has, and that it builds without a warning and asks no other host for anything."""

from __future__ import annotations

import importlib.util
import io
import logging
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from mkdocs.config import load_config
from mkdocs.structure.files import Files, get_files

from btlang.diagnostics.codes import CODES
from tests.profiles import only_long
from tests.test_house import ROOT

_LOADED = re.compile(
    r"<(?:script|img|iframe)[^>]* src=\"?(?:https?:)?//|<link[^>]* rel=\"?(?:stylesheet|icon|preconnect)[^>]*//"
)


@pytest.fixture(scope="module")
def files() -> Files:
    config = load_config(str(ROOT / "mkdocs.yml"))
    return config.plugins.on_files(get_files(config), config=config)


def test_pages_keep_their_paths(files: Files) -> None:
    outside = [f"btlang/diagnostics/pages/{code}.md" for code in CODES]
    inside = [page.relative_to(ROOT).as_posix() for page in (ROOT / "docs").rglob("*.md")]
    assert files.src_uris.keys() >= {*inside, *outside, "README.md", "docs/pictures/tea.svg", "docs/cpp/whenever.hpp"}
    assert "docs/site_pages.py" not in files.src_uris  # no page links to it


def test_two_files_never_become_one_page(files: Files) -> None:
    pages = [file.dest_uri for file in files]
    assert sorted(pages) == sorted(set(pages))
    assert {file.src_uri: file.dest_uri for file in files if file.name == "index"}["README.md"] == "index.html"


def test_linked_folders_show_their_files(files: Files) -> None:
    examples = files.src_uris["examples"]
    assert examples.is_documentation_page()
    assert "## first_steps.txt\n\n~~~~text\n# A first mission" in examples.content_string
    assert files.src_uris["examples/worlds"].dest_uri == "examples/worlds/contents.html"


@only_long
def test_it_builds_strictly_and_loads_nothing_from_elsewhere(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--site-dir", str(tmp_path)],
        cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT), "NO_MKDOCS_2_WARNING": "1"}, text=True, check=False,
        stderr=subprocess.PIPE,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    pages = {path: path.read_text(encoding="utf-8") for path in tmp_path.rglob("*.html")}
    assert [path.name for path, text in pages.items() if _LOADED.search(text)] == []
    assert "def parse_tree" not in pages[tmp_path / "api.html"]
    assert 'id="btlang.api.parse_tree"' in pages[tmp_path / "api.html"]
    assert "FILE|NUMBER" in pages[tmp_path / "cli.html"].replace(r"FILE\|NUMBER", "")
    assert '"title":"BT013: an unknown name"' in (tmp_path / "search" / "search_index.json").read_text(encoding="utf-8")


@pytest.fixture
def playground(monkeypatch: pytest.MonkeyPatch) -> Any:
    spec = importlib.util.spec_from_file_location("site_playground", ROOT / "docs" / "site_playground.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_without_npm_the_page_says_so(
    playground: Any, monkeypatch: pytest.MonkeyPatch, caplog: Any, tmp_path: Path
) -> None:
    monkeypatch.setattr(playground, "build", lambda: "npm can't be reached")
    config = SimpleNamespace(site_dir=str(tmp_path))
    page = SimpleNamespace(file=SimpleNamespace(src_uri="docs/try_it.md", dest_uri="try_it.html"), content="help")
    with caplog.at_level(logging.INFO):
        playground.on_pre_build(config=config)
    assert "The playground isn't built" in caplog.text
    assert [record.levelname for record in caplog.records] == ["INFO"]  # a warning would end the strict build
    text = (ROOT / "docs" / "try_it.md").read_text(encoding="utf-8")
    shown = playground.on_page_markdown(text, page=page, config=config, files=None)
    assert shown.startswith('# Try it\n\n!!! warning "No playground"\n    The playground wasn\'t built')
    assert playground.on_post_page("page", page=page, config=config) == "page"
    playground.on_post_build(config=config)
    assert list(tmp_path.iterdir()) == []


def test_the_playground_has_what_it_runs(playground: Any) -> None:
    archive = playground.sources()
    assert archive == playground.sources()  # else it would be built again each time
    names = zipfile.ZipFile(io.BytesIO(archive)).namelist()
    assert {"btlang/playground/stand_ins/numpy/__init__.py", "rapidfuzz/fuzz_py.py", "btlang/session.py"} <= {*names}
    assert "btlang/_resources/keywords/en/language.toml" in names
    assert [name for name in names if "/server/" in name or "__pycache__" in name or name.endswith(".so")] == []
