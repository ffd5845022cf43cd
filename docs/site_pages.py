"""The hook of MkDocs that makes the site of `docs/` and of whatever its pages link to.

On the site, each file keeps its path in the repository, so a relative link leads to the same file as on GitHub. A link
to a file outside `docs/` brings that file: Markdown and pictures as they are, other text as a page that shows it, and a
folder as a page that shows its files. The API reference, on GitHub a list of signatures, is made by mkdocstrings here.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

import btlang

ROOT = Path(__file__).parent.parent
CONTENTS = "docs/README.md"
API = "docs/api.md"
CODES = "btlang/diagnostics/pages/"
_FENCED = re.compile(r"^(```+|~~~+).*?^\1$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\]\((?!\w+:)([^)#\s]+)")
_FILE_OF_FENCE = re.compile(r"^```(\w+) ([\w.]+)$", re.MULTILINE)
_CODE_IN_TABLE = re.compile(r"`[^`\n]*\\\|[^`\n]*`")  # GitHub wants `a\|b` there, Python-Markdown `a|b`
_SECTION = re.compile(r"^## (\w+)\n.*?(?=^## |\Z)", re.MULTILINE | re.DOTALL)
_PICTURES = (".svg", ".png", ".gif")
_LANGUAGES = {".py": "python", ".toml": "toml", ".xml": "xml", ".hpp": "cpp", ".json": "json"}


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Put the pages of `docs/` at their paths in the repository, and add what they link to."""
    waiting = []
    for file in list(files):
        if file.src_dir != config.docs_dir or file.src_uri.startswith("assets/"):
            continue
        files.remove(file)
        if file.src_uri.endswith(".md"):  # all else is there if a page links to it
            path = f"docs/{file.src_uri}"
            page = _file(path, config, "contents.html" if path == CONTENTS else file.dest_uri)
            files.append(page)
            waiting.append(page)
    while waiting:
        for path in _links(waiting.pop()):
            if path not in files.src_uris and (ROOT / path).exists():
                file = _file(path, config)
                files.append(file)
                if file.is_documentation_page():
                    waiting.append(file)
    return files


def _links(page: File) -> Iterator[str]:
    """Yield the paths of the files that a page links to."""
    for link in _LINK.findall(_FENCED.sub("", page.content_string)):
        path = posixpath.normpath(posixpath.join(posixpath.dirname(page.src_uri), link))
        if not path.startswith(".."):
            yield path


def _file(path: str, config: MkDocsConfig, at: str | None = None) -> File:
    found = ROOT / path
    if found.suffix in (".md", *_PICTURES):
        return File(path, str(ROOT), config.site_dir, config.use_directory_urls, dest_uri=at)
    at = f"{path}/contents.html" if found.is_dir() else f"{path}.html"
    file = File(path, None, config.site_dir, config.use_directory_urls, dest_uri=at)
    file.content_string = _folder(found) if found.is_dir() else f"# {found.name}\n\n{_shown(found)}"
    file.is_documentation_page = lambda: True  # otherwise only Markdown is
    file.edit_uri = None
    return file


def _folder(folder: Path) -> str:
    """A page with the files of a folder, and links to the folders in it."""
    inner = sorted(path for path in folder.iterdir() if path.name[0] not in "._")
    parts = [f"# {folder.name}", *(f"- [{path.name}]({folder.name}/{path.name})" for path in inner if path.is_dir())]
    for path in inner:
        if path.suffix == ".md":
            parts.append(f"## {path.name}\n\n[Read it]({folder.name}/{path.name}).")
        elif path.is_file() and path.suffix not in _PICTURES:
            parts.append(f"## {path.name}\n\n{_shown(path)}")
    return "\n\n".join(parts)


def _shown(path: Path) -> str:
    return f"~~~~{_LANGUAGES.get(path.suffix, 'text')}\n{path.read_text(encoding='utf-8').rstrip()}\n~~~~"


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Show the name of a file above its text, and make the API reference from the docstrings."""
    if page.file.src_uri.startswith(CODES):
        markdown += "\n[All message codes](../../../docs/codes.md)\n"
    if page.file.src_uri.startswith(("btlang/", "examples")):
        page.meta["search"] = {"boost": 0.3}  # below the pages that explain
    if page.file.src_uri == API:
        markdown = _SECTION.sub(_documented, markdown.replace("by `python -m tests.generate`", "of `btlang`"))
    markdown = _CODE_IN_TABLE.sub(lambda cell: cell[0].replace(r"\|", "|"), markdown)
    return _FILE_OF_FENCE.sub(r'```\1 title="\2"', markdown)


_HOMES = {name: module for module, names in btlang.PUBLIC.items() for name in names}

_FUNCTION = """\
    options:
      heading_level: 2
      show_root_full_path: false
      show_root_heading: true
      show_root_toc_entry: true
"""


def _documented(section: re.Match[str]) -> str:
    """A section about a public name as mkdocstrings makes it, with the fields of a class; others stay as they are."""
    name = section[1]
    if name not in _HOMES:
        return section[0]
    if name[0].islower():
        return f"::: {_HOMES[name]}.{name}\n{_FUNCTION}\n"
    parameters = re.search(rf"^`{name}\(.*\)`$", section[0], re.MULTILINE)
    shown = f"{parameters[0]}\n\n" if parameters else ""
    return f"## {name}\n\n{shown}::: {_HOMES[name]}.{name}\n\n"
