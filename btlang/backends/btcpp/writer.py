"""A tree as XML of BehaviorTree.CPP: format 4, or the dialect of version 3."""

from __future__ import annotations

from btlang.backends.btcpp.markup import INDENT, Markers, margin
from btlang.backends.btcpp.models import Uses, model_part
from btlang.backends.btcpp.names import tree_ids
from btlang.backends.btcpp.typed import typed
from btlang.frontends.btcpp.dialect import told_by_shapes
from btlang.frontends.btcpp.file import SPOKEN_NAME
from btlang.frontends.btcpp.models import why_no_port
from btlang.frontends.btcpp.origin import Element, Markup, TreeOrigin, XmlOrigin
from btlang.frontends.btcpp.spelling import MAIN_TREE, SPELL, spelled_3
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.btcpp.spelling import Pairs

_DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>'
_NOTHING = TreeOrigin((), {}, {}, {}, {}, {})


def to_xml(tree: Tree, vocabulary: Lexicon, *, dialect: int = 4) -> str:
    """The XML of a tree, in lines, with a line end at the end.

    A tree that was read from a file of the same dialect, and not changed since, is written with all that stood in the
    file: its tags, attributes, texts and comments. Any other is written in the one canonical way. `dialect` is 4 or 3.
    Raises MissionError where a name or text isn't allowed in XML (BT129), ValueError for another dialect.
    """
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
        if self._origin is None:
            self._uses = Uses(tree, vocabulary, dialect)
            for node in self._uses.misnamed:
                self._markers.wrong("name", why_no_port("name"), node.span)
            self._kind = self._uses.kind
            self._ids = tree_ids(tree, self._uses.ids, dialect)
            if dialect == 4:
                self._tree = typed(tree, self._uses.port_types)
        else:
            kinds = {model.id: model.kind for model in tree.models}
            self._kind = lambda node_id: kinds.get(node_id, "")  # any other tag is told by the origin
            written = {name: dict(own.attributes).get("ID", name) for name, own in self._origin.trees.items()}
            self._ids = {name: ID for name, ID in written.items() if name != ID}

    def write(self) -> str:
        markers, origin = self._markers, self._origin
        head: tuple[str, ...] = (_DECLARATION,)
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
        """The main tree may have another name in the file than in the tree, where it has none."""
        if self._origin is None:
            return {}
        others = dict(self._tree.subtrees)
        return {name: self._tree.name for name in self._origin.trees if name not in others}

    def _root_attributes(self) -> Pairs:
        main = (("main_tree_to_execute", self._ids[self._tree.name]),)
        return (("BTCPP_format", "4"), *main) if self._dialect == 4 else self._format_3() + main

    def _format_3(self) -> Pairs:
        """Told only where the file would be taken for one of format 4."""
        spelled = (spelled_3(node, self._kind, self._ids) for node in self._tree.walk())
        shapes = {(tag, *(key for key, _ in pairs)) for tag, pairs in spelled}
        return (("BTCPP_format", "3"),) if told_by_shapes(shapes) == 4 else ()

    def _items(self) -> tuple[Element | Markup | str, ...]:
        """The main tree, the others in their order, the models."""
        models = None if self._uses is None else model_part(self._uses.models(), self._ids)
        return (self._tree.name, *(name for name, _ in self._tree.subtrees), *((models,) if models else ()))

    def _tree_attributes(self, name: str) -> Pairs:
        written = self._ids[name]
        spoken = name or MAIN_TREE
        return (("ID", written),) if spoken == written else (("ID", written), (SPOKEN_NAME, spoken))

    def _tree_lines(self, name: str, root: Node, lines: list[str]) -> None:
        origin = _NOTHING if self._origin is None else self._origin.trees[name]
        attributes = self._tree_attributes(name) if self._origin is None else origin.attributes
        lines.append(f"{INDENT}<BehaviorTree{self._markers.attributes(attributes)}>")
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


def _own_origin(tree: Tree, dialect: int) -> XmlOrigin | None:
    """What the file of the tree told, where it is of this tree and dialect."""
    origin = tree.origin
    if isinstance(origin, XmlOrigin) and origin.dialect == dialect:
        if origin.root is tree.root and origin.subtrees is tree.subtrees:
            return origin
    return None
