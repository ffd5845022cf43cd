"""One XML file: its parts below <root>, without regard to other files."""

from __future__ import annotations

import re
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.btcpp.dialect import dialect_of
from btlang.frontends.btcpp.fragments import Notes, as_written, fragment
from btlang.frontends.btcpp.models import ModelReader, among, odd
from btlang.frontends.btcpp.nodes import NodeReader
from btlang.frontends.btcpp.origin import Element, Markup, TreeOrigin
from btlang.frontends.btcpp.scan import Document, Note
from btlang.frontends.btcpp.spelling import IN_NO_ID, KINDS, MODEL
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, NodeModel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.btcpp.fragments import Items
    from btlang.frontends.btcpp.spelling import Pairs

_PARTS = ("BehaviorTree", MODEL, "include")
_NAMING = frozenset(("BehaviorTree", SUBTREE, *KINDS))
_REFUSED = re.compile(f"(?![\\x00-\\x1f])[{IN_NO_ID}]")  # English refuses control characters itself
SPOKEN_NAME = "_name"
"""The attribute of a BehaviorTree with the name that its tree has in English, where that can be no ID."""


class TreeHead(Record):
    """A BehaviorTree before its nodes are read.

    Its name, its ID in the file ("" where it has none), its element, the first element behind it. Unless it `is_sound`,
    its nodes aren't read.
    """

    name: str
    written: str
    index: int
    end: int
    span: Span
    is_sound: bool = True

    @property
    def id(self) -> str:
        """What SubTree nodes call it."""
        return self.written or self.name


class XmlFile:
    """The content of a document. `problems` is what is wrong with it; then the rest may lack parts. `warnings` report
    what BehaviorTree.CPP ignores.

    Nodes are read by `read_trees`, when the trees of all included files are known. `within` is the dialect of the file
    that includes it, `path` is where it really is.
    """

    def __init__(self, document: Document, within: int = 3, path: str = "") -> None:
        self.document = document
        self.path = path
        self.notes = Notes(document)
        self.problems: list[Diagnostic] = []
        self.warnings: list[Diagnostic] = []
        self.heads: list[TreeHead] = []
        self.includes: list[tuple[dict[str, str], Span]] = []
        self.models: dict[str, NodeModel] = {}
        self.trees: list[tuple[str, Node]] = []
        self.origins: dict[str, TreeOrigin] = {}
        self.uses: dict[str, list[Node]] = {}
        """The SubTree nodes of each tree."""
        self.describes_nodes = False
        """Whether it has a TreeNodesModel, if only an empty one."""
        self._parts: list[int] = []
        self._described: dict[str, int] = {}  # the elements of the models
        self.attributes = document.attributes(0)
        self.dialect = dialect_of(document, within)
        self._survey()

    @property
    def names(self) -> dict[str, str]:
        """The names of its trees by their IDs."""
        return {head.id: head.name for head in self.heads}

    @property
    def root_span(self) -> Span:
        """The start tag of <root>."""
        return self.document.span(0)

    def model_span(self, node_id: str) -> Span:
        """The start tag of the model of a node."""
        return self.document.span(self._described[node_id])

    def _survey(self) -> None:
        document = self.document
        tag = document.elements[0][0]
        if tag != "root":
            advice = "BehaviorTree.CPP has its trees in <root>."
            self._wrong(
                "BT122", document.span(0), what=f"<{tag}>", problem="cannot be the outermost tag", advice=advice
            )
            return
        models = ModelReader(document, self.notes)
        described = -1
        self._parts = document.parts()
        for at, end in pairwise((*self._parts, len(document.elements))):
            tag, attributes = document.elements[at][0], document.attributes(at)
            if tag == "BehaviorTree":
                self._add_tree(at, end, attributes)
            elif tag == MODEL and described >= 0:
                help = "Put all models into the first one."
                self._wrong("BT122", document.span(at), what=f"A second <{tag}>", problem="isn't allowed", advice=help)
            elif tag == MODEL:
                described = at
                self.describes_nodes = True
                for element, model in models.read(at):
                    if self.models.setdefault(model.id, model) is model:
                        self._described[model.id] = element
            elif tag == "include":
                self.includes.append((attributes, document.span(at)))
            else:
                help = among(tag, _PARTS)
                self._wrong("BT122", document.span(at), what=f"<{tag}>", problem="isn't allowed in <root>", advice=help)
        self.warnings += models.warnings
        self._find_texts()
        self._find_gaps()
        if self.dialect == 4:
            self._find_refused()

    def _find_refused(self) -> None:
        """IDs that BehaviorTree.CPP refuses, each where it stands first."""
        document = self.document
        found: dict[str, int] = {}
        for at, (tag, flat, _, _) in enumerate(document.elements):
            if tag in _NAMING and "ID" in flat[::2]:
                found.setdefault(flat[flat.index("ID") + 1], at)
        for node_id, at in found.items():
            refused = _REFUSED.search(node_id)
            if refused is not None and node_id.strip():
                what = "a blank" if refused[0] == " " else f"'{refused[0]}'"
                self.warnings.append(diagnostic("BT238", document.span(at), (), None, id=node_id, what=what))

    def _add_tree(self, index: int, end: int, attributes: dict[str, str]) -> None:
        written = attributes.get("ID", "")
        unnamed = sum(not head.written for head in self.heads)
        name = attributes.get(SPOKEN_NAME, "") or written or f"BehaviorTree_{unnamed}"
        span = self.document.span(index)
        count = self.document.depths[index:end].count(2)
        if count != 1:
            problem = f"contains {count} nodes instead of one" if count else "contains no node"
            advice = "Put them into one, such as <Sequence>." if count else "Put one into it, such as <Sequence>."
            self._wrong("BT122", span, what=span.text, problem=problem, advice=advice)
        self.heads.append(TreeHead(name, written, index, end, span, count == 1))

    def _find_texts(self) -> None:
        """Texts without effect: those of models are descriptions."""
        elements = self.document.elements
        ends = [(at, self.document.end(at)) for at in self._parts if elements[at][0] == MODEL]
        for note, inside in self.notes.texts:
            if not any(first < inside < end for first, end in ends):
                what = f"This text in <{elements[inside][0]}>"
                self.warnings.append(odd(self._text_span(note), what, "has no effect", _TEXT_ADVICE))

    def _find_gaps(self) -> None:
        """Attributes without a blank before them."""
        source = self.document.source
        for start in self.document.gaps:
            span = Span(source, start, source.text.find("=", start))
            fix = (Span(source, start, start), " ")
            advice = "BehaviorTree.CPP reads it, but other programs don't."
            self.warnings.append(odd(span, f"'{span.text.strip()}'", "has no blank before it", advice, fix))

    def _text_span(self, note: Note) -> Span:
        """Its first line, looked for behind the tag before it."""
        line = note.text.strip().splitlines()[0]
        document = self.document
        last = document.span(note.before - 1)
        start = document.source.text.find(line, last.end)
        return last if start < 0 else Span(document.source, start, start + len(line))

    def read_trees(self, names: dict[str, str], kinds: dict[str, str], defaults: dict[str, Pairs]) -> None:
        """Reads the nodes.

        `names` are the trees of all files by the ID that they have there, `defaults` those of the ports of each tree by
        its name; `kinds` gets those that tags declare.
        """
        document = self.document
        reader = NodeReader(document, self.dialect, names, kinds, defaults)
        for head in (head for head in self.heads if head.is_sound):
            first, end = head.index + 1, head.end
            root, tags = reader.read(first, end)
            self.trees.append((head.name, root))
            self.uses[head.name] = reader.uses[::-1]
            reader.uses.clear()
            notes = self.notes
            before, inside, heading, behind = notes.among(first, end)
            after = as_written(notes.inside(head.index))
            attributes = tuple(document.attributes(head.index).items())
            self.origins[head.name] = TreeOrigin(attributes, tags, before, inside, heading, behind, after)
        self.problems += reader.problems

    def items(self) -> tuple[Element | Markup | str, ...]:
        """The parts of <root> in their order, a str being the name of a tree."""
        found: Items = []
        heads = {head.index: head.name for head in self.heads}
        for at in self._parts:
            found += map(Markup, as_written(self.notes.before(at)))
            found.append(heads[at] if at in heads else fragment(self.document, self.notes, at))
        found += map(Markup, as_written(self.notes.inside(0)))
        return tuple(found)

    def head(self) -> tuple[str, ...]:
        """What stands before <root>."""
        document = self.document
        prolog = (document.declaration, document.doctype)
        return tuple(text for text in prolog if text) + tuple(note.text for note in self.notes.before(0))

    def foot(self) -> tuple[str, ...]:
        """What stands behind it."""
        return tuple(note.text for note in self.notes.inside(-1))

    def _wrong(self, code: str, span: Span, **arguments: str) -> None:
        self.problems.append(diagnostic(code, span, (), None, **arguments))


_TEXT_ADVICE = "To keep it as a note, write it as a comment: <!-- ... -->"
