"""The parts of an XML file beside its tree, so that it can be written again as it was."""

from __future__ import annotations

from btlang.support.record import Record
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.btcpp.spelling import Pairs, Spelling


class Element(Record):
    """A part of a file that is no tree, such as an include or TreeNodesModel.

    `items` are inner elements, texts, and comments and processing instructions as they are written (`Markup`).
    """

    tag: str
    attributes: Pairs = ()
    items: tuple[Element | Markup | str, ...] = ()


class Markup(Record):
    """A comment, processing instruction or text as it is written."""

    text: str


class TreeOrigin(Record):
    """How a BehaviorTree was written. Nodes are known by their number in preorder, 0 for the root.

    `tags` are those nodes whose tag or attributes are not the usual ones; `before` and `inside` are comments and texts
    before a node and behind its last child, as XML, `heading` and `behind` those on the line of its start tag and of
    its end, and `after` those behind the root.
    """

    attributes: Pairs
    tags: dict[int, Spelling]
    before: dict[int, tuple[str, ...]]
    inside: dict[int, tuple[str, ...]]
    heading: dict[int, tuple[str, ...]]
    behind: dict[int, tuple[str, ...]]
    after: tuple[str, ...] = ()


class XmlOrigin(Record):
    """What the file of a tree holds beside it. It belongs only to the tree of `root` and `subtrees`.

    `items` are the parts of <root> in their order, a str being the name of a tree; `trees` describes the trees of this
    file, without those of included files; `head` and `foot` are what stands around <root>. `file` is the name of
    the file without its folder, "" for a text, `digest` that of its text (see kept.py).
    """

    dialect: int
    root: Node
    subtrees: tuple[tuple[str, Node], ...]
    attributes: Pairs
    items: tuple[Element | Markup | str, ...]
    trees: dict[str, TreeOrigin]
    head: tuple[str, ...] = ()
    foot: tuple[str, ...] = ()
    file: str = ""
    digest: str = ""
