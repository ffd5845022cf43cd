"""The XML writer for BehaviorTree.CPP: format 4, or the dialect of version 3."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.backends.btcpp.markup import INDENT, Markers, margin, sound_comment
from btlang.backends.btcpp.models import Uses, model_part, tree_ids
from btlang.backends.btcpp.typed import give_types
from btlang.frontends.btcpp.dialect import dialect_of_shapes
from btlang.frontends.btcpp.file import SPOKEN_NAME
from btlang.frontends.btcpp.kept import Kept, kept_in
from btlang.frontends.btcpp.origin import Element, Markup, TreeOrigin, XmlOrigin
from btlang.frontends.btcpp.spelling import MAIN_TREE, SPELL, spelled_3
from btlang.text.source import Source
from btlang.tree.comments import FOOT, HEAD, comments_by_line, line_of
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.btcpp.spelling import Pairs

_DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>'


def to_xml(tree: Tree, vocabulary: Lexicon, *, dialect: int = 4, onto: Source | None = None) -> str:
    """Return the XML of a tree, in lines, with a line end at the end; or the file `onto`, with what has changed in the
    tree.

    A tree that was read from a file of the same dialect, and not changed since, is written with all that stood in the
    file: its tags, attributes, texts and comments. Any other is written in the one canonical way. `dialect` is 4 or 3.
    Raises MissionError where a name or text isn't allowed in XML (BT129), ValueError for another dialect.
    """
    if onto is not None:
        from btlang.backends.btcpp.onto import write_onto

        return write_onto(onto, tree, vocabulary)
    if dialect not in SPELL:
        raise ValueError(f"there is no dialect {dialect}")
    return _Writer(tree, vocabulary, dialect).write()


class _Writer:
    def __init__(self, tree: Tree, vocabulary: Lexicon, dialect: int) -> None:
        self._tree = tree
        self._vocabulary = vocabulary
        self._dialect = dialect
        self._markers = Markers()
        self._origin = _own_origin(tree, dialect)
        self._uses: Uses | None = None
        self._comments: dict[str, dict[int, tuple[str, ...]]] = {}
        self._head: tuple[str, ...] = ()
        self._foot: tuple[str, ...] = ()
        self._kept = kept_in(tree.origin.text) if isinstance(tree.origin, Source) else Kept()
        if self._origin is None:
            tree = tree.replace(models=(*self._kept.models, *tree.models))
            self._uses = Uses(tree, vocabulary, dialect)
            for node in self._uses.misnamed:
                self._markers.wrong_port("name", node.span)
            self._kind = self._uses.kind
            self._ids = tree_ids(tree, self._uses.ids, dialect)
            if dialect == 4:
                self._tree = give_types(tree, self._uses.port_types)
            self._find_comments(tree.origin)
        else:
            kinds = {model.id: model.kind for model in tree.models}
            self._kind = lambda node_id: kinds.get(node_id, "")  # the origin has any other tag
            written = {name: dict(own.attributes).get("ID", name) for name, own in self._origin.trees.items()}
            self._ids = {name: ID for name, ID in written.items() if name != ID}

    def write(self) -> str:
        markers, origin = self._markers, self._origin
        head: tuple[str, ...] = (_DECLARATION, *self._head)
        foot: tuple[str, ...] = ()
        if origin is not None:
            head, foot = origin.head, origin.foot
        attributes = self._root_attributes() if origin is None else origin.attributes
        items = self._items() if origin is None else origin.items
        lines = [*head, f"<root{markers.attributes(attributes)}>"]
        trees = {self._tree.name: self._tree.root, **dict(self._tree.subtrees)}
        names = self._names_in_file()
        for item in items:
            if isinstance(item, Markup):
                lines.append(INDENT + item.text)
            elif isinstance(item, Element):
                lines += markers.part(item, 1)
            else:
                self._tree_lines(item, trees[names.get(item, item)], lines)
        lines += ["</root>", *foot, ""]
        markers.finish()
        return "\n".join(lines)

    def _names_in_file(self) -> dict[str, str]:
        """Return the names of trees in the file. The main tree may have one there if it has none in the tree."""
        if self._origin is None:
            return {}
        others = dict(self._tree.subtrees)
        return {name: self._tree.name for name in self._origin.trees if name not in others}

    def _root_attributes(self) -> Pairs:
        main = (("main_tree_to_execute", self._ids[self._tree.name]), *self._kept.root)
        return (("BTCPP_format", "4"), *main) if self._dialect == 4 else self._format_3() + main

    def _format_3(self) -> Pairs:
        """Return the attribute of the format, only if the file would otherwise be taken for one of format 4."""
        spelled = (spelled_3(node, self._kind, self._ids) for node in self._tree.walk())
        shapes = {(tag, *(key for key, _ in pairs)) for tag, pairs in spelled}
        return (("BTCPP_format", "3"),) if dialect_of_shapes(shapes) == 4 else ()

    def _items(self) -> tuple[Element | Markup | str, ...]:
        """Return the main tree, the others in their order, the models; with the comments of a mission."""
        models = self._models()
        found: list[Element | Markup | str] = [self._tree.name]
        for name, _ in self._tree.subtrees:
            found += (*map(Markup, self._comments.get(name, {}).pop(0, ())), name)
        return (*found, *models, *map(Markup, self._foot))

    def _models(self) -> list[Element]:
        """Return the models that the mission keeps from its file, and further ones of what it uses."""
        assert self._uses is not None
        known = {model.id for model in self._kept.models}
        found = list(self._kept.parts)
        further = model_part([model for model in self._uses.models() if model.id not in known], self._ids)
        if further is not None:
            found[:1] = [found[0].replace(items=found[0].items + further.items) if found else further]
        return found

    def _tree_attributes(self, name: str) -> Pairs:
        written = self._ids[name]
        spoken = name or MAIN_TREE
        named = (("ID", written),) if spoken == written else (("ID", written), (SPOKEN_NAME, spoken))
        return (*named, *dict(self._kept.trees).get(written, ()))

    def _find_comments(self, source: object) -> None:
        """Find the comments of a mission, each before the node of its statement."""
        if not isinstance(source, Source) or "#" not in source.text:
            return
        comments = comments_by_line(source, self._vocabulary.orthography, self._tree)
        self._head, self._foot = _mark(comments.pop(HEAD, ())), _mark(comments.pop(FOOT, ()))
        for name, root in ((self._tree.name, self._tree.root), *self._tree.subtrees):
            before: dict[int, tuple[str, ...]] = {}
            for number, node in enumerate(Tree(root).walk()):
                if lines := comments.pop(line_of(node), None):
                    before[number] = _mark(lines)
            self._comments[name] = before

    def _tree_lines(self, name: str, root: Node, lines: list[str]) -> None:
        if self._origin is None:
            before = self._comments.get(name, {})
            origin = TreeOrigin(self._tree_attributes(name), {}, before, {}, {}, {})
        else:
            origin = self._origin.trees[name]
        lines.append(f"{INDENT}<BehaviorTree{self._markers.attributes(origin.attributes)}>")
        spell, kind, ids, write = SPELL[self._dialect], self._kind, self._ids, self._markers.attributes
        tags, before, inside = origin.tags, origin.before, origin.inside
        number = 0
        stack: list[tuple[Node | str | tuple[str, ...], int]] = [(root, 2)]
        while stack:
            node, depth = stack.pop()
            space = margin(depth)
            if isinstance(node, str):
                lines.append(space + node)
                continue
            if isinstance(node, tuple):
                lines += [space + text for text in node]
                continue
            if before and number in before:
                lines += [space + text for text in before[number]]
            if number in tags:
                tag, pairs = tags[number]
            else:
                tag, pairs = spell(node, kind, ids)
            written = write(pairs, node.span) if pairs else ""
            comments = inside.get(number, ()) if inside else ()
            beside = " ".join(("", *origin.heading.get(number, ()))) if origin.heading else ""
            end = " ".join(("", *origin.behind.get(number, ()))) if origin.behind else ""
            if node.children or comments or beside:
                lines.append(f"{space}<{tag}{written}>{beside}")
                stack.append((f"</{tag}>{end}", depth))
                if comments:
                    stack.append((comments, depth + 1))
                stack += [(child, depth + 1) for child in reversed(node.children)]
            else:
                lines.append(f"{space}<{tag}{written}/>{end}")
            number += 1
        lines += [INDENT * 2 + text for text in origin.after]
        lines.append(f"{INDENT}</BehaviorTree>")


def _mark(lines: Iterable[str]) -> tuple[str, ...]:
    return tuple(f"<!-- {sound_comment(line)} -->" for line in lines)


def _own_origin(tree: Tree, dialect: int) -> XmlOrigin | None:
    """Return what the file of the tree held beside it, if it is of this tree and dialect."""
    origin = tree.origin
    if isinstance(origin, XmlOrigin) and origin.dialect == dialect:
        if origin.root is tree.root and origin.subtrees is tree.subtrees:
            return origin
    return None
