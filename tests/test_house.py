"""Rules of the house that no tool checks."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Container, Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

import btlang
from btlang.robots.bodies.body import Body
from btlang.robots.worlds import world_file
from btlang.vocabulary import keyword_file, language_tables
from btlang.vocabulary.capabilities import CAPABILITIES

ROOT = Path(__file__).parent.parent
FOLDERS = ("btlang", "tests", "grammar", "keywords", "examples", "docs", "editors", ".ci")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
LEFT_OUT = {"__pycache__", "samples", "dist", "node_modules"}


def files(folder: Path) -> Iterator[Path]:
    """Yields the files that the rules are about, in a folder and those below."""
    for name, below, names in os.walk(folder):
        below[:] = [inner for inner in below if inner not in LEFT_OUT]
        yield from (Path(name, file) for file in names if not file.endswith((".svg", ".png", ".gif", ".words")))


FILES = sorted(path for folder in FOLDERS for path in files(ROOT / folder))
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
MODULES = [path for path in FILES if path.suffix == ".py"]
BORROWED = {ROOT / path for path in PROJECT["tool"]["ruff"]["extend-exclude"]}
MOST_LINES = 400
LONG: dict[str, str] = {
    "btlang/task/commands.schema.json": "made from the classes of commands",
    "examples/guide/robot.toml": "all of a humanoid",
    "btlang/web/package-lock.json": "made by npm",
    "editors/vscode/package-lock.json": "made by npm",
    "btlang/robots/robot.py": "what robots can do, one capability after the other",
    "btlang/cli/verbs.py": "the table of verbs",
    "docs/cli.md": "made from the help of the commands",
    "docs/api.md": "made from the docstrings",
    "btlang/behavior.py": "trees in Python: behaviors, the words of their functions, and how a mission is made of them",
    "btlang/session.py": "a session, and the runs that it makes",
    "btlang/robots/simulation/robot.py": "the robot, one capability after the other",
    "btlang/task/store/task_store.py": "the store, one table after the other",
    "btlang/run/events.py": "the classes of events, from which the schema of logs is made",
    "btlang/ros/robot/robot.py": "the same over ROS 2",
    "btlang/testing/words.toml": "the words of tests",
    "btlang/vocabulary/keyword_file.py": "what may stand in a keyword file, one table after the other",
    "btlang/vocabulary/reading_context.py": "what words stand for at a place of a mission",
    "btlang/vocabulary/lexicon.py": "all that the words of a language are made into, which is then frozen",
    "docs/words.md": "made from the keyword files",
    "docs/engine.md": "tables of behaviour that the tests play",
    "docs/keywords.md": "every key of keyword files",
    "keywords/en/language.toml": "the words of English",
    "tests/english/read.out": "made from the sentences",
    "btlang/frontends/mission/tokens/word_reader.py": "what is asked of words, in the order in which it is asked",
    "btlang/frontends/mission/tokens/rewording.py": "what is said in other words, one kind after the other",
    "btlang/tree/ast.py": "the classes of syntax nodes, which are read together",
}
"""Files with more lines, each with the reason why it is one thing: no concept is cut for the sake of its length."""


def name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def test_long_files_have_a_reason() -> None:
    long = {name(path) for path in FILES if len(text(path).splitlines()) > MOST_LINES}
    assert long == set(LONG)


def test_no_work_is_left_as_a_note() -> None:
    note = re.compile(r"\b(?:TO" r"DO|FIX" r"ME|XX" r"X)\b")
    assert [name(path) for path in FILES if note.search(text(path))] == []


def test_every_module_says_what_it_is_for() -> None:
    silent = [path for path in MODULES if not text(path).startswith('"""')]
    packages = {path for path in silent if path.name == "__init__.py" and "tests" in path.parts}
    assert [name(path) for path in silent if path not in packages | BORROWED] == []


def test_no_modules_import_each_other() -> None:
    """Imports inside functions and for types alone are counted, too: such a circle is one thing in several files."""
    names = {".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in MODULES if "btlang" in path.parts}
    imports = {name: imported(ast.parse(text(path)), names) - {name} for name, path in names.items()}
    left = dict(imports)
    while free := [name for name, others in left.items() if not others & left.keys()]:
        for name in free:
            del left[name]
    assert not left, "these, or what they import, import each other"


def imported(tree: ast.Module, names: Container[str]) -> set[str]:
    """The modules that one imports, wherever it does."""
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name for name in (node.module, *inner) if name in names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names if alias.name in names}
    return found


def test_every_layer_has_its_paragraph_in_the_architecture() -> None:
    page = text(ROOT / "ARCHITECTURE.md")
    folders = [path.name for path in (ROOT / "btlang").iterdir() if (path / "__init__.py").exists()]
    assert [folder for folder in folders if f"**`btlang/{folder}/`**" not in page] == []


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_files_named_in_documents_exist(page: Path) -> None:
    """Every `btlang/...` or other path from the root in back quotes, and every link."""
    roots = "|".join(re.escape(folder) for folder in FOLDERS)
    named = re.findall(rf"`((?:{roots})/[\w./]*)`", text(page))
    linked = [link for link in re.findall(r"\]\(([^)#]+)", text(page)) if not link.startswith("https://")]
    missing = [path for path in named if not (ROOT / path).exists() and "samples/bad/" not in path]
    missing += [link for link in linked if not (page.parent / link).exists()]
    assert missing == []


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_lead_to_headings(page: Path) -> None:
    linked = re.findall(r"\]\((?!https?:)([^)#\s]*)#([^)]+)\)", text(page))
    assert [
        (file, place) for file, place in linked if place not in headings(page.parent / file if file else page)
    ] == []


def headings(page: Path) -> set[str]:
    """The headings of a page as links name them."""
    found = re.findall(r"^#+ (.*)$", text(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in found}


def test_documents_name_every_key() -> None:
    pages = ("keywords.md", "language_words.md", "worlds.md", "robots.md")
    keywords, words, worlds, robots = (text(ROOT / "docs" / page) for page in pages)
    keys = keyword_file._TOP | keyword_file._ENTRY | keyword_file._TYPE
    assert [key for key in sorted(keys) if not re.search(rf"`\[*{key}\]*`", keywords + words)] == []
    assert [role for role in language_tables.ROLES if f"`{role}`" not in words.partition("## Roles")[2]] == []
    assert [need for need in CAPABILITIES if f'`"{need}"`' not in keywords] == []
    assert [key for key in Body.fields if f"`{key}`" not in robots] == []
    assert [kind for kind in world_file._FAULTS if f'`"{kind}"`' not in worlds] == []


def test_one_version() -> None:
    assert btlang.__version__ == PROJECT["project"]["version"]
    assert f"\nversion: {btlang.__version__}\n" in text(ROOT / "CITATION.cff")
    assert f"\n## [{btlang.__version__}]" in text(ROOT / "CHANGELOG.md")
    try:
        installed = version("btlang")
    except PackageNotFoundError:
        pytest.skip("btlang is not installed here; in CI it is")
    assert installed == btlang.__version__


def test_btc_says_its_version() -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-m", "btlang", "--version"], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout == f"btc {btlang.__version__}\n"


def test_contracts_name_every_part() -> None:
    """The contract about rclpy has to list its modules, so a new one could be forgotten."""
    contracts = PROJECT["tool"]["importlinter"]["contracts"]
    [contract] = [contract for contract in contracts if contract.get("forbidden_modules") == ["rclpy"]]
    parts = {
        f"btlang.{path.stem}"
        for path in (ROOT / "btlang").iterdir()
        if (path.suffix == ".py" and path.stem != "__init__") or (path / "__init__.py").exists()
    }
    assert parts - {"btlang.ros"} == set(contract["source_modules"])


LIGHT = [
    (["check", "-c", "move forward 1 m then say done"], "lark rich prompt_toolkit asyncio numpy rclpy interegular"),
    (["run", "-c", "move forward 1 m then wave", "--speed", "max", "--quiet"], "lark rich prompt_toolkit numpy rclpy"),
    (["tree", "-c", "wave then nod"], "rich prompt_toolkit"),
    (["words"], "rich prompt_toolkit"),
    (["explain"], "rich prompt_toolkit"),
]
"""Commands, and what they must not import: it would take longer than all that they do."""


@pytest.mark.parametrize(("command", "heavy"), LIGHT, ids=lambda value: value[0] if isinstance(value, list) else "")
def test_light_start(command: list[str], heavy: str) -> None:
    program = (
        f"import sys; from btlang.cli import main; code = main({command!r}); "
        f"found = {set(heavy.split())!r} & set(sys.modules); sys.exit(f'imports {{sorted(found)}}' if found else code)"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
