"""Writing a tree onto the XML file that it came from: only what was edited changes, all other bytes stay."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher

from btlang.backends.btcpp.markup import sound_comment
from btlang.backends.btcpp.models import Uses, tree_ids
from btlang.backends.btcpp.rewriting import Rewriter
from btlang.backends.english.comments import lines_of
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.frontends.btcpp.file import SPOKEN_NAME, XmlFile
from btlang.frontends.btcpp.reader import MAIN, read_xml
from btlang.frontends.btcpp.scan import Note, scanned
from btlang.frontends.btcpp.spelling import KINDS, MAIN_TREE, SPELL, TO_4, is_editors, is_xml_name
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Source
from btlang.tree.alignment import Alignment
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.comments import FOOT, HEAD, comments_by_line, line_of
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from btlang.frontends.btcpp.spelling import Pairs, Spelling

    Raw: TypeAlias = Mapping[tuple[str, ...], str]
    """Comments of nodes that are gone, as they were written, by their lines in English."""
    Lines: TypeAlias = dict[float, Counter[str]]
    """How often comments stand at the lines of a mission."""


def write_onto(original: Source, tree: Tree, vocabulary: Lexicon) -> str:
    """Return the text of the XML file `original` with the nodes and comments of a tree from a mission.

    Nodes that have not changed keep their bytes, as do comments, models and all else. Raises MissionError where the
    file is no tree (BT120 to BT129), or where the tree changes what a file has that this one includes (BT135).
    """
    return _Onto(original, tree, vocabulary).written()


_OWN_TAGS = CATALOGUE.keys() | TO_4.keys() | {SUBTREE}
"""Tags that have no kind."""


class _FileComment(Record):
    """A comment of the file with the line of the mission that it belongs to; `lines` are its lines in English."""

    note: Note
    lines: tuple[str, ...]


class _Onto:
    def __init__(self, original: Source, tree: Tree, vocabulary: Lexicon) -> None:
        self._vocabulary = vocabulary
        self._file = XmlFile(scanned(original))
        is_there = tree.name in (head.name for head in self._file.heads)  # then it is the main tree in any case
        self._before = read_xml(original, tree.name if is_there else "")
        subtrees = tuple((name, _copy_shared(root)) for name, root in tree.subtrees)
        self._after = tree.replace(root=_copy_shared(tree.root), subtrees=subtrees)
        document = self._file.document
        self._dialect = self._file.dialect
        self._heads = {head.name: head for head in self._file.heads}
        others = dict(self._before.subtrees)
        self._old = {(name if name in others else ""): others.get(name, self._before.root) for name in self._heads}
        self._elements: dict[int, int] = {}
        for name, head in self._heads.items():
            root = self._old[name if name in others else ""]
            for number, node in enumerate(Tree(root).walk(), head.index + 1):
                self._elements[id(node)] = number
        leaves = [document.elements[number][0] for number in self._elements.values()]
        self._kind_tags = {tag in KINDS for tag in leaves if tag in KINDS or tag not in _OWN_TAGS} or {False}
        self._new = {"": self._after.root, **dict(self._after.subtrees)}
        self._elsewhere = {name: root for name, root in others.items() if name not in self._heads}
        if "" not in self._old:
            self._elsewhere[""] = self._before.root
        self._renamed = self._find_renamed()
        self._alignment = self._align()
        self._ids = self._find_ids()
        uses = Uses(self._after, vocabulary, self._dialect)
        kinds = {model.id: model.kind for model in self._before.models}
        self._kind: Callable[[str], str] = lambda node_id: kinds.get(node_id) or uses.kind(node_id)
        self._text = Rewriter(document, self._file.notes, self._find_known, self._spell)
        self._mission = tree.origin if isinstance(tree.origin, Source) else None

    # -- what is what

    def _find_renamed(self) -> dict[str, str]:
        """Find new names by old ones, if one tree alone has another name."""
        gone = [name for name in self._old if name not in self._new]
        come = [name for name in self._new if name not in self._old and name not in self._elsewhere]
        return {gone[0]: come[0]} if len(gone) == len(come) == 1 else {}

    def _align(self) -> Alignment:
        named = {self._renamed.get(name, name): root for name, root in self._old.items()}
        roots = [(root, self._new[name]) for name, root in named.items() if name in self._new]
        gone = [root for name, root in named.items() if name not in self._new]
        come = [root for name, root in self._new.items() if name not in named and name not in self._elsewhere]
        included = [(root, self._new[name]) for name, root in self._elsewhere.items() if name in self._new]
        alignment = Alignment([*roots, *included], gone, come, _features)
        wrong = [_in_other_file(name, root, self._new[name]) for name, root in self._elsewhere.items()
                 if name in self._new and not alignment.is_equal(root, self._new[name])]  # fmt: skip
        if wrong:
            raise MissionError(wrong)
        return alignment

    def _find_ids(self) -> dict[str, str]:
        """Return the ID of each tree in the file by its name, those of new trees as the file's dialect allows them."""
        nodes = {node.id for node in self._after.walk()}
        made = tree_ids(self._after, nodes, self._dialect)
        heads = {name: head.written for name, head in self._heads.items() if head.written and name in self._new}
        written = {name: id for name, id in heads.items() if id not in nodes}  # what is new may have the ID of a tree
        return made | written

    def _find_known(self, node: Node) -> int | None:
        old = self._alignment.old(node)
        return self._elements.get(id(old)) if old is not None else None

    def _spell(self, node: Node) -> Spelling:
        return self._in_style(node, SPELL[self._dialect](node, self._kind, self._ids))

    def _spell_before(self, node: Node) -> Spelling:
        written = {name: head.written for name, head in self._heads.items() if head.written}
        return self._in_style(node, SPELL[self._dialect](node, self._kind, written))

    def _in_style(self, node: Node, usual: Spelling) -> Spelling:
        """Spell a node with a kind tag if all leaves of the file have one, and without if none has."""
        tag, pairs = usual
        if tag in KINDS and True not in self._kind_tags and is_xml_name(node.id) and ("ID", node.id) in pairs:
            return node.id, tuple(pair for pair in pairs if pair != ("ID", node.id))
        if tag == node.id and self._kind_tags == {True} and not node.children and node.id not in CATALOGUE:
            return self._kind(node.id), (("ID", node.id), *pairs)
        return usual

    # -- writing

    def written(self) -> str:
        """Return the text; see `write_onto`."""
        for node in self._after.walk():
            old = self._alignment.old(node)
            if old is not None and id(old) in self._elements:
                self._change(self._elements[id(old)], old, node)
        self._name_trees()
        self._change_comments()
        trees = {head.index: self._root_of(name) for name, head in self._heads.items()}
        known = {self._renamed.get(name, name) for name in self._old} | self._elsewhere.keys()
        added = [(self._tree_attributes(name), root) for name, root in self._new.items() if name not in known]
        return self._text.write(trees, added)

    def _root_of(self, name: str) -> Node | None:
        key = name if name in self._old else ""
        return self._new.get(self._renamed.get(key, key))

    def _tree_attributes(self, name: str) -> Pairs:
        written = self._ids[name if name in self._ids else ""]
        return (("ID", written),) if name == written else (("ID", written), (SPOKEN_NAME, name))

    def _change(self, number: int, old: Node, new: Node) -> None:
        tag, before = self._spell_before(old)
        other, after = self._spell(new)
        if tag != other and self._file.document.elements[number][0] == tag:
            self._text.rename(number, other)
        kept = tuple(pair for pair in before if not is_editors(pair[0]))
        wanted = tuple(pair for pair in after if not is_editors(pair[0]))
        if sorted(kept) != sorted(wanted):
            self._text.attributes(number, kept, wanted)

    def _name_trees(self) -> None:
        """Change the IDs of trees that have other names now."""
        for name, head in self._heads.items():
            old = name if name in self._old else ""
            new = self._renamed.get(old, old)
            if not old and self._after.name != self._before.name:
                new = self._after.name or MAIN_TREE
                main = self._file.attributes.get(MAIN)
                if main is not None:
                    self._text.attributes(0, ((MAIN, main),), ((MAIN, self._ids[self._after.name]),))
            elif new == old and (not head.written or self._ids.get(old, head.written) == head.written):
                continue
            there = self._file.document.attributes(head.index)
            before = tuple((key, there[key]) for key in ("ID", SPOKEN_NAME) if key in there)
            self._text.attributes(head.index, before, self._tree_attributes(new))

    # -- comments

    def _change_comments(self) -> None:
        """Change the comments to those of the mission, if its text is there."""
        if self._mission is None:
            return
        nodes = list(self._after.walk())
        wanted = comments_by_line(self._mission, self._vocabulary.orthography, self._after)
        first: dict[float, Node] = {}
        for node in nodes:
            first.setdefault(line_of(node), node)
        top = HEAD if self._after.name else min((line for line in first if line), default=HEAD)
        there, gone = self._comments_by_line(top)
        come: Lines = {}
        left: Lines = {}
        for line in sorted({*there, *wanted}):
            has = Counter(text for said in there.get(line, ()) for text in said.lines)
            come[line] = Counter(wanted.get(line, ())) - has
            left[line] = has - Counter(wanted.get(line, ()))
        stays = self._find_staying(come, left, nodes)
        raw = {said.lines: self._raw(said.note) for said in gone}
        for line in sorted({*there, *wanted}):
            kept = stays[0].get(line, Counter()), stays[1].get(line, Counter())
            new = self._change_line(there.get(line, []), wanted.get(line, []), kept, raw)
            if line in (HEAD, FOOT):
                self._text.add_around(new, at_end=line == FOOT)
            elif new:
                self._add_comments(first[line], new)

    def _add_comments(self, node: Node, comments: list[str]) -> None:
        """Add comments before a node; not in a file that this one includes."""
        for name, root in self._elsewhere.items():
            if name in self._new and any(node is each for each in Tree(self._new[name]).walk()):
                raise MissionError([_in_other_file(name, root, self._new[name])])
        self._text.add_comments(node, comments)

    def _find_staying(self, come: Lines, left: Lines, nodes: Sequence[Node]) -> tuple[Lines, Lines]:
        """Find the new and old comments, by line, that are only said in another statement: as English puts comments
        before whole ones, they stand at a node around their own one, or the other way round.
        """
        above: defaultdict[float, set[float]] = defaultdict(set)
        around: dict[int, Node] = {id(child): node for node in nodes for child in node.children}
        for node in nodes:
            place = line_of(node)
            if place in come or place in left:
                outer: Node | None = node
                while (outer := around.get(id(outer))) is not None:
                    above[place].add(line_of(outer))
        new: Lines = {line: Counter() for line in come}
        old: Lines = {line: Counter() for line in left}
        for at, texts in left.items():
            for text in texts.elements():
                for line, others in come.items():
                    is_same = {HEAD, FOOT} & {at, line} or at in above[line] or line in above[at]
                    if is_same and others[text] > new[line][text]:
                        new[line][text] += 1
                        old[at][text] += 1
                        break
        return old, new

    def _change_line(
        self, there: list[_FileComment], wanted: list[str], stays: tuple[Counter[str], Counter[str]], raw: Raw
    ) -> list[str]:
        """Change the comments of one statement to the wanted ones, but for old and new ones that stay elsewhere; return
        those that are new.
        """
        has = [(said, at, text) for said in there for at, text in enumerate(said.lines)]
        texts = [text for _, _, text in has]
        if Counter(texts) == Counter(wanted):
            return []
        changed: defaultdict[int, dict[int, str | None]] = defaultdict(dict)
        come: list[str] = []
        codes = SequenceMatcher(a=texts, b=wanted, autojunk=False).get_opcodes()
        same = Counter(text for tag, first, last, _, _ in codes if tag == "equal" for text in texts[first:last])
        in_other_order = (Counter(texts) & Counter(wanted)) - same  # these stay where they are
        old_stay, new_stay = stays[0] + in_other_order, stays[1] + in_other_order
        for tag, first, last, begin, end in codes:
            if tag == "equal":
                continue
            old = [each for each in has[first:last] if not _take(old_stay, each[2])]
            new = [text for text in wanted[begin:end] if not _take(new_stay, text)]
            for (said, at, _), text in zip(old, new, strict=False):
                changed[id(said)][at] = text
            for said, at, _ in old[len(new) :]:
                changed[id(said)][at] = None
            come += new[len(old) :]
        for said in there:
            if id(said) in changed:
                self._change_comment(said, changed[id(said)])
        return list(_comments(come, raw))

    def _change_comment(self, said: _FileComment, lines: Mapping[int, str | None]) -> None:
        if len(lines) == len(said.lines) and not any(lines.values()):
            self._text.remove_comment(said.note)
            return
        raw = self._raw(said.note)
        kept: list[str] = []
        at = 0
        text: str | None = None
        for line in raw.removeprefix("<!--").removesuffix("-->").split("\n"):
            if not lines_of((f"<!--{line}-->",)):
                kept.append(line)
                continue
            text = lines.get(at, line)
            if text is not None:
                inner = line.strip()
                kept.append(line if at not in lines else line.replace(inner, sound_comment(text)))
            at += 1
        inner = "\n".join(kept)
        if line.strip() and text is None:  # the last line is gone: what ends it ends the one before
            inner = inner.rstrip() + line[len(line.rstrip()) :]
        self._text.change(*self._text.span_of(said.note), f"<!--{inner}-->")

    def _raw(self, note: Note) -> str:
        """Return a comment with its line ends."""
        start, end = self._text.span_of(note)
        return self._file.document.source.text[start:end]

    def _comments_by_line(self, top: float) -> tuple[dict[float, list[_FileComment]], list[_FileComment]]:
        """Return the comments of the file by the line of the mission in which their node is said, and those of removed
        nodes. What stands before all trees belongs to the first statement. What English can't say (processing
        instructions) moves from a removed node to the next one that isn't.
        """
        found: defaultdict[float, list[_FileComment]] = defaultdict(list)
        gone: list[_FileComment] = []
        unsaid: list[str] = []

        def put(notes: Iterable[Note], node: Node | None, line: float | None = None) -> None:
            for note in (note for note in notes if not note.is_text):
                lines = tuple(lines_of((note.text,)))
                if node is None and line is None:
                    self._text.remove_comment(note)
                    if lines:
                        gone.append(_FileComment(note, lines))
                    else:
                        unsaid.append(self._raw(note))
                elif lines:
                    found[line_of(node) if node is not None else line].append(_FileComment(note, lines))  # type: ignore[index]

        notes, document = self._file.notes, self._file.document
        put(notes.before(0), None, top)
        heads = {head.index: name for name, head in self._heads.items()}
        waiting: list[Note] = []
        for part in document.parts():
            waiting += notes.before(part)
            if part in heads:
                root = self._root_of(heads[part])
                put(waiting, root)
                put(notes.inside(part), root)
                waiting = []
        put((*waiting, *notes.inside(0), *notes.inside(-1)), None, FOOT)
        for root in self._old.values():
            for old in Tree(root).walk():
                number, new = self._elements[id(old)], self._alignment.new(old)
                places = notes.before(number), notes.heading(number), notes.behind(number), notes.inside(number)
                put((note for place in places for note in place), new)
                if new is not None and unsaid:
                    self._text.add_comments(new, unsaid)
                    unsaid = []
        self._text.add_around(unsaid, at_end=True)
        return found, gone


def _in_other_file(name: str, old: Node, new: Node) -> Diagnostic:
    path = old.span.source.name if old.span is not None else ""
    return diagnostic("BT135", new.span or NOWHERE, name=name, path=path)


def _features(node: Node) -> list[tuple[str, str]]:
    return [port for port in node.ports if not is_editors(port[0])]


def _comments(lines: Sequence[str], raw: Raw) -> Iterator[str]:
    """Yield new comments; several lines that were one comment are one again, as it was written."""
    at = 0
    while at < len(lines):
        same = [old for old in raw if tuple(lines[at : at + len(old)]) == old]
        longest = max(same, key=len, default=())
        yield raw[longest] if longest else f"<!-- {sound_comment(lines[at])} -->"
        at += len(longest) or 1


def _take(counter: Counter[str], text: str) -> bool:
    """Take one of them, if there is one."""
    if counter[text] <= 0:
        return False
    counter[text] -= 1
    return True


def _copy_shared(root: Node) -> Node:
    """Return the tree with no node in two places, as the body of a loop may be."""

    def combine(node: Node, children: list[Node]) -> Node:
        return node.replace(children=tuple(children))  # type: ignore[no-any-return]

    return fold(root, lambda node: node.children, combine)
