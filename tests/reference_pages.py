"""Makes the pages of docs/ that list all codes, nodes and words, each from the table that the program reads."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.diagnostics.codes import CODES
from btlang.diagnostics.explain import title_of
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.tree.catalogue import CATALOGUE, MOST_NODES, NodeKind, Port
from btlang.vocabulary.items import Item, items

_MADE = "<!-- Made by `python -m tests.generate`. -->"
_CODE_PAGES = "../btlang/diagnostics/pages"
_WORLD = "the world"  # the topic of the names in a world
_SHOWN = 3
"""Ways to say one thing; `btc words` lists the others."""


def codes_page() -> str:
    """The page of all codes of messages, with a link to the page of each."""
    rows = [
        (f"[{code}]({_CODE_PAGES}/{code}.md)", kind.severity, title_of(code) + f" (`{kind.name}`)" * bool(kind.name))
        for code, kind in sorted(CODES.items())
    ]
    about = (
        "Each message has a code, which keeps its meaning in later versions. `btc explain BT013` prints the page of a "
        "code. [Messages](messages.md) says how to read them, and how to silence a warning by the name in brackets."
    )
    return _page("All message codes", about, _table(("code", "severity", "about"), rows))


def nodes_page() -> str:
    """The page of all built-in nodes with their children and ports, by the library that has them."""
    about = (
        "The control nodes, decorators and leaves that every tree can use. [What each node does](engine.md) defines "
        "their behavior, and [nodes by their ids](language/nodes.md) says how to write them in a mission. A port "
        "without a default must be given. The actions and conditions of a robot are [words](words.md)."
    )
    parts = []
    for origin in dict.fromkeys(kind.origin for kind in CATALOGUE.values()):
        rows = [_node(kind) for kind in CATALOGUE.values() if kind.origin == origin]
        parts += [f"## Nodes of {origin}", _table(("node", "kind", "children", "ports", "in version 3"), rows)]
    return _page("All nodes", about, *parts)


def _node(kind: NodeKind) -> tuple[str, ...]:
    ports = "<br>".join(_port(name, port) for name, port in kind.ports.items())
    old = ", ".join(f"`{tag}`" for tag in kind.tags_3)
    return f"`{kind.id}`", kind.kind, _children(kind), ports + " and any others" * kind.any_ports, old


def _children(kind: NodeKind) -> str:
    if kind.roles:
        return ", ".join(f"{role} (optional)" if at >= kind.least else role for at, role in enumerate(kind.roles))
    if kind.most == MOST_NODES:
        return f"{kind.least} or more"
    return f"{kind.least} to {kind.most}" if kind.least < kind.most else str(kind.most)


def _port(name: str, port: Port) -> str:
    bounds = "" if port.least is None else f"from {port.least}"
    default = "" if port.default is None else f"default `{port.default}`" if port.default else "may be left out"
    direction = "" if port.direction == "input" else port.direction
    facts = ", ".join(fact for fact in (port.type and f"`{port.type}`", port.unit, bounds, direction, default) if fact)
    return f"`{name}`" + f": {facts}" * bool(facts)


def words_page() -> str:
    """The page of everything that missions can say, by topic, as `btc words --all` lists it."""
    about = (
        "What missions can say with the English that ships. `btc words wave` lists all ways to say it, and knows the "
        "words of your keyword files and your world. `[...]` is optional, `{...}` takes a value, `a/b` is a choice, "
        "and `time(s)` is time or times. A condition isn't a command: it needs a word such as `if` or `until`. "
        "[Keyword files](keywords.md) add words."
    )
    known = items(world_vocabulary())
    parts = []
    for topic in dict.fromkeys(item.topic for item in known if item.topic != _WORLD):
        rows = [(_ways(item), item.help, item.example) for item in known if item.topic == topic]
        parts += [f"## {topic.capitalize()}", _table(("say", "meaning", "for example"), rows)]
    return _page("All words", about, *parts)


def _ways(item: Item) -> str:
    shown = "<br>".join(f"`{way}`" for way in item.ways[:_SHOWN])
    left = len(item.ways) - _SHOWN
    return shown + f"<br>and {left} more" * (left > 0) + " (condition)" * (item.sort == "condition")


def _page(title: str, *parts: str) -> str:
    return "\n\n".join([f"# {title}", _MADE, *parts]) + "\n"


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *(tuple(cell.replace("|", "\\|") for cell in row) for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
