"""Pages of Markdown about a project: a page for each file with a chapter for each tree, an index, and their files."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from btlang.backends.english import to_english
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source, unwritable, write_file, write_output
from btlang.documents.project import DocumentedProject, KeyReader, TreeChapter, nodes_of
from btlang.frontends.btcpp.models import nav2_models
from btlang.pictures.tree_picture import to_svg
from btlang.text.formatting import one_line, printable
from btlang.tree.catalogue import BEHAVIOR_TREE_CPP, CATALOGUE, SUBTREE
from btlang.tree.comments import KEPT
from btlang.tree.node import NodeModel, PortModel, Tree
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    Key = TypeVar("Key")


_MARKS = re.compile(r"[\\`*_\[\]<>|~#&!$^{}]")
_BREAK = "\N{WORD JOINER}"  # between what GitHub would make a link of, though nobody wrote one
_LINKS = re.compile(r"(?i)(?<=:)(?=//)|(?<=mailto)(?=:)|(?<=xmpp)(?=:)|(?<=www)(?=\.)|(?=@)")
_BLOCKS = re.compile(r"^(?:[-+=]|\d+(?=[.)]))")


def escape_markdown(text: str) -> str:
    """Escape a text so that it is shown as it is, on one line."""
    line = _LINKS.sub(_BREAK, one_line(" ".join(text.split())))
    line = _MARKS.sub(r"\\\g<0>", line)
    block = _BLOCKS.match(line)
    if block is None:
        return line
    return f"\\{line}" if not block[0].isdigit() else f"{block[0]}\\{line[block.end() :]}"


def code(text: str) -> str:
    """Return a text on one line as code, also in a table."""
    line = one_line(" ".join(text.split())) or " "
    marks = "`" * (max(map(len, re.findall("`+", line)), default=0) + 1)
    room = " " if "`" in (line[0], line[-1]) else ""
    return f"{marks}{room}{line}{room}{marks}".replace("|", "\\|")


def block(text: str) -> Iterator[str]:
    """Yield lines as a block that is shown as it is."""
    marks = "`" * max(3, *(len(run) + 1 for run in re.findall("`+", text) or [""]))
    yield from (f"{marks}text", *printable(text).rstrip("\n").split("\n"), marks)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Yield a table of cells that are Markdown; no lines where it has no rows."""
    rows = list(rows)
    if rows:
        yield from (_row(heads), _row(["---"] * len(heads)), *map(_row, rows))


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def file_name(text: str) -> str:
    """Return a text as a part of the names of files and places in pages: letters and digits of ASCII, `.`, `_` and
    `-`.
    """
    return re.sub(r"[^A-Za-z0-9._-]+", "-", text).strip("-.") or "tree"


MADE = "<!-- Made by btc compile --to markdown. What you change here is lost when it is made again. -->"
INDEX = "index.md"


class PageWriter:
    """A writer of the pages of a project; `pages` are the names of their files by those of the trees."""

    def __init__(self, project: DocumentedProject) -> None:
        self._project = project
        self.pages = _distinct({name: file_name(name) for name in project.files}, ".md", INDEX)
        places = {
            (one.file, one.name): f"{self.pages[one.file].removesuffix('.md')}.{file_name(one.name)}"
            for one in project.chapters
        }
        self._pictures = _distinct(places, ".svg")

    def page(self, file: str, *, pictures: bool = True) -> str:
        """Return the page of a file."""
        chapters = [chapter for chapter in self._project.chapters if chapter.file == file]
        lines = [MADE, "", f"# {escape_markdown(file)}", ""]
        if len(chapters) > 1:
            lines += [*(f"- {self._link(chapter, file)}{_about(chapter)}" for chapter in chapters), ""]
        for chapter in chapters:
            lines += self._chapter(chapter, pictures=pictures)
        if not chapters:
            lines += ["This file has only models of nodes.", "", *self._models(file)]
        return "\n".join(lines).rstrip("\n") + "\n"

    def pictures(self) -> Iterator[tuple[str, str]]:
        """Yield the name and text of each SVG file."""
        for one in self._project.chapters:
            yield self._pictures[one.file, one.name], to_svg(one.tree, one.vocabulary, title=one.name)

    def index(self) -> str:
        """Return a table of all trees and the files, and the trees that nobody uses."""
        project = self._project
        lines = [MADE, "", "# Trees", ""]
        ordered = sorted(project.chapters, key=lambda one: (one.name.casefold(), one.name, one.file))
        rows = [
            (
                self._link(one), self._page_link(one.file), str(len(project.users(one))),
                escape_markdown(one.description),
            )
            for one in ordered
        ]  # fmt: skip
        lines += [*table(("tree", "file", "used by", "what it does"), rows), ""]
        unused = [one for one in project.chapters if not one.runs_first and not project.users(one)]
        if unused:
            lines += ["## Trees that nobody uses", "", "No tree uses these, and no file starts with them.", ""]
            lines += [*(f"- {self._link(one)} in {escape_markdown(one.file)}" for one in unused), ""]
        lines += ["## Files", "", *(f"- {self._page_link(name)}" for name in project.files), ""]
        if project.left_out:
            lines += ["## Files that are no missions", "", *(f"- {escape_markdown(name)}" for name in project.left_out)]
        return "\n".join(lines).rstrip("\n") + "\n"

    def _chapter(self, chapter: TreeChapter, *, pictures: bool) -> Iterator[str]:
        yield from (f'<a id="{self._place(chapter)}"></a>', "", f"## {escape_markdown(chapter.name)}", "")
        if chapter.description:
            yield from (escape_markdown(chapter.description), "")
        if chapter.runs_first and sum(one.file == chapter.file for one in self._project.chapters) > 1:
            yield from ("The file starts with this tree.", "")
        yield from (*self._english(chapter), "")
        if pictures:
            yield from (
                f"![The tree {escape_markdown(chapter.name)}]({self._pictures[chapter.file, chapter.name]})",
                "",
            )
        yield from _part(
            "Ports and keys", table(("name", "use", "type", "default", "what it is"), self._ports(chapter))
        )
        yield from _part("Nodes", table(("node", "kind", "times", "what it does"), self._nodes(chapter)))
        yield from _part("Uses", (f"- {self._use(name, chapter.file)}" for name in chapter.uses))
        users = self._project.users(chapter)
        yield from _part(
            "Used by", (f"- {self._link(one, chapter.file)} in {escape_markdown(one.file)}" for one in users)
        )

    def _english(self, chapter: TreeChapter) -> Iterator[str]:
        text = chapter.text
        if not text:
            try:
                text = to_english(chapter.tree, chapter.vocabulary)
            except MissionError as error:
                yield escape_markdown(error.diagnostics[0].message)
                return
        yield from block("\n".join(line for line in text.split("\n") if not line.startswith(KEPT)))

    def _ports(self, chapter: TreeChapter) -> Iterator[tuple[str, ...]]:
        """Yield the ports that the model of the tree has, then the other keys in the order of the tree."""
        model = self._project.models.get(chapter.name)
        ports = {port.name: port for port in model.ports} if model is not None and model.kind == SUBTREE else {}
        keys: dict[str, set[str]] = {}
        reader = KeyReader(self._project.models, chapter.vocabulary)
        for root in (chapter.tree.root, *(root for _, root in chapter.tree.subtrees)):
            for key, uses in reader.keys(root).items():
                keys.setdefault(key, set()).update(uses)
        for name in (*ports, *(key for key in keys if key not in ports)):
            port = ports.get(name) or PortModel(name, "")
            use = ", ".join(([port.direction] if port.direction else []) + sorted(keys.get(name, ())))
            default = "" if port.default is None else code(port.default)
            yield code(name), use, code(port.type) if port.type else "", default, escape_markdown(port.text)

    def _nodes(self, chapter: TreeChapter) -> Iterator[tuple[str, ...]]:
        """Yield all nodes but those of BehaviorTree.CPP itself."""
        found = nodes_of(chapter.tree)
        for id in sorted(found):
            kind = CATALOGUE.get(id)
            if kind is not None and kind.origin == BEHAVIOR_TREE_CPP:
                continue
            entry = chapter.vocabulary.entry(id)
            model = self._project.models.get(id) or nav2_models([id]).get(id)
            sorts = [model.kind if model else "", kind.kind if kind else "", entry.sort.title() if entry else ""]
            texts = [model.text if model else "", entry.help if entry else ""]
            sort, about = (next(filter(None, candidates), "") for candidates in (sorts, texts))
            yield code(id), sort, str(len(found[id])), escape_markdown(about)

    def _models(self, file: str) -> Iterator[str]:
        """Yield the nodes that a file describes."""
        models = sorted(self._project.described[file], key=lambda model: (model.kind, model.id))
        yield from table(("node", "kind", "ports", "what it does"), map(_describe, models))

    def _link(self, chapter: TreeChapter, page: str = "") -> str:
        """Link to a chapter, from the page of a file."""
        target = "" if page == chapter.file else self.pages[chapter.file]
        return f"[{escape_markdown(chapter.name)}]({target}#{self._place(chapter)})"

    def _use(self, name: str, file: str) -> str:
        used = self._project.used(name, file)
        return self._link(used, file) if used is not None else f"{escape_markdown(name)} (in no file here)"

    def _page_link(self, file: str) -> str:
        return f"[{escape_markdown(file)}]({self.pages[file]})"

    def _place(self, chapter: TreeChapter) -> str:
        return f"tree-{self._pictures[chapter.file, chapter.name].removesuffix('.svg')}"


def to_markdown(tree: Tree, vocabulary: Lexicon) -> str:
    """Return the page of one tree with its subtrees, without a picture."""
    title = tree.name or "Mission"
    chapter = TreeChapter(title, title, tree, vocabulary, runs_first=True)
    project = DocumentedProject((title,), (chapter,), {model.id: model for model in tree.models})
    return PageWriter(project).page(title, pictures=False)


def _describe(model: NodeModel) -> tuple[str, ...]:
    return code(model.id), model.kind, ", ".join(code(port.name) for port in model.ports), escape_markdown(model.text)


def _about(chapter: TreeChapter) -> str:
    return f": {escape_markdown(chapter.description)}" if chapter.description else ""


def _part(title: str, lines: Iterator[str]) -> Iterator[str]:
    """Yield a heading with these lines, nothing where there are none."""
    found = list(lines)
    if found:
        yield from (f"### {title}", "", *found, "")


def _distinct(names: Mapping[Key, str], ending: str, *taken: str) -> dict[Key, str]:
    """Name of files, each only once, also where letters of both sizes are one."""
    found: dict[Key, str] = {}
    used = {name.lower() for name in taken}
    for key, name in names.items():
        made, number = f"{name}{ending}", 2
        while made.lower() in used:
            made, number = f"{name}-{number}{ending}", number + 1
        used.add(made.lower())
        found[key] = made
    return found


def write_pages(project: DocumentedProject, paths: Sequence[str], out: str | None) -> bool:
    """Write the pages about what was read at these paths; a page of somebody else isn't replaced.

    One file becomes a page on standard output, or in a file whose name ends in `.md`; all else becomes a folder. False
    where that needs a folder and none is named. Raises MissionError (BT009).
    """
    writer = PageWriter(project)
    is_single = len(paths) == 1 and not os.path.isdir(paths[0])
    if out is None or (out.endswith(".md") and not os.path.isdir(out)):
        if not is_single:
            return False
        [file] = project.files
        if out is not None:
            _check(out)
        write_output(writer.page(file, pictures=False), out)
        return True
    contents = {writer.pages[file]: writer.page(file) for file in project.files}
    contents |= {INDEX: writer.index(), **dict(writer.pictures())}
    try:
        os.makedirs(out, exist_ok=True)
    except OSError as error:
        raise MissionError([unwritable(out, error)]) from None
    found = {os.path.join(out, name): content for name, content in contents.items()}
    for path in found:
        if path.endswith(".md"):
            _check(path)
    for path, content in found.items():
        write_file(path, content)
    return True


def _check(path: str) -> None:
    """Raise MissionError (BT009) where a page is there that was not made here."""
    if os.path.isfile(path) and not read_source(path).text.startswith(MADE):
        raise MissionError(
            [unwritable(path, "a page is there that btc didn't make; choose another folder, or remove it")]
        )
