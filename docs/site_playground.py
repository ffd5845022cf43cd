"""The hook of MkDocs that makes the page *Try it* the playground: btlang in the browser, without a server.

Without Node or npm the site is built all the same: the build and the page say that the playground isn't there.
"""

from __future__ import annotations

import io
import logging
import os
import runpy
import shutil
import tempfile
import zipfile
from collections.abc import Iterator
from html import escape
from pathlib import Path

import rapidfuzz
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parent.parent
TRY_IT = "docs/try_it.md"
BUILT = ROOT / "build" / "playground"
FILES = "playground"
"""The folder of the site with the files of the playground."""
_LEFT_OUT = {"cli", "documents", "lsp", "maps", "monitor", "projects", "repl", "ros", "server", "templates", "web"}
"""The parts of btlang that a page without a server and without files never asks."""
_KEPT = {".py", ".toml", ".json", ".words"}
_PATIENCE = 240.0  # seconds for npm, and for the script
_log = logging.getLogger("mkdocs.hooks.playground")
_problem = ""


def sources() -> bytes:
    """Return an archive of what the playground runs: the same bytes for the same files."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, path in sorted(_sources()):
            archive.writestr(zipfile.ZipInfo(name), path.read_bytes())
    return packed.getvalue()


def _sources() -> Iterator[tuple[str, Path]]:
    """Yield the names in the archive, and the files.

    rapidfuzz is there as its authors write it in Python, which it uses where its compiled parts are missing.
    """
    parts = [("btlang", ROOT / "btlang"), ("btlang/_resources/keywords", ROOT / "keywords")]
    for name, folder in [*parts, ("rapidfuzz", Path(rapidfuzz.__file__).parent)]:
        for path in folder.rglob("*"):
            inside = path.relative_to(folder)
            if path.suffix in _KEPT and inside.parts[0] not in _LEFT_OUT and "__pyinstaller" not in inside.parts:
                yield f"{name}/{inside.as_posix()}", path


def build() -> str:
    """Make the playground in BUILT, unless it's that of the present sources. Return what went wrong, "" for nothing."""
    hatch = runpy.run_path(str(ROOT / "hatch_build.py"))
    given = sources()
    with tempfile.TemporaryDirectory(prefix="btlang-playground-") as folder:
        archive = Path(folder, "sources.zip")
        archive.write_bytes(given)
        script = "playground.mjs", str(archive), "dist"
        problem = hatch["build"](
            ROOT / "btlang" / "web", BUILT, *script, more=given, install=hatch["NPM"], patience=_PATIENCE
        )
    return str(problem)


def on_pre_build(*, config: MkDocsConfig) -> None:
    """Make the playground, and say if that isn't possible here."""
    global _problem
    _problem = build()
    if _problem:
        _log.info("The playground isn't built, and the page 'Try it' says so: %s", _problem)


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Say on the page that the playground isn't there; the playground need not say where it is."""
    if page.file.src_uri != TRY_IT:
        return markdown
    note = "The playground wasn't built with this site: Node or npm couldn't be used there."
    title, _, rest = markdown.split("\n\n", 2)
    return "\n\n".join([title, *([f'!!! warning "No playground"\n    {note}'] if _problem else []), rest])


def on_post_page(output: str, *, page: Page, config: MkDocsConfig) -> str:
    """Put the playground in the place of the page, with what the page says as its help."""
    if page.file.src_uri != TRY_IT or _problem:
        return output
    text = (BUILT / "index.html").read_text(encoding="utf-8")
    start = escape(os.path.relpath("index.html", os.path.dirname(page.file.dest_uri) or "."))
    return text.replace("FILES", FILES).replace("SITE", start).replace("HELP", page.content or "")


def on_post_build(*, config: MkDocsConfig) -> None:
    """Bring the files of the playground."""
    if not _problem:
        ignored = shutil.ignore_patterns("index.html", "sources.sha256")
        shutil.copytree(BUILT, Path(config.site_dir, FILES), ignore=ignored, dirs_exist_ok=True)
