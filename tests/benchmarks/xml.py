"""How fast XML is read and written, beside ElementTree: `python -m tests.benchmarks.xml [--rounds 25] [--nodes 5000]`.

ElementTree parses and serialises the same file. The least time of rounds in which all take turns; on a machine that
others use, trust only the ratios.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from xml.etree import ElementTree

from btlang.backends.btcpp import to_xml
from btlang.frontends.btcpp.reader import read_xml
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.support.gc_pause import gc_paused
from btlang.text.source import Source

LEAVES = 4  # below each Fallback


def five_thousand(nodes: int, dialect: int) -> str:
    """The XML of a tree with about so many nodes, as Groot would lay it out."""
    if dialect == 4:
        root, leaf = (
            '<root BTCPP_format="4" main_tree_to_execute="MainTree">',
            '<GoTo place="room {}" speed="{{speed}}"/>',
        )
    else:
        root, leaf = '<root main_tree_to_execute="MainTree">', '<Action ID="GoTo" place="room {}" speed="{{speed}}"/>'
    lines = [root, '  <BehaviorTree ID="MainTree">', "    <Sequence>"]
    for part in range(nodes // (LEAVES + 1)):
        lines.append(f'      <Fallback name="part {part}">')
        lines += ["        " + leaf.format(number) for number in range(LEAVES)]
        lines.append("      </Fallback>")
    return "\n".join([*lines, "    </Sequence>", "  </BehaviorTree>", "</root>", ""])


def least(works: dict[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Milliseconds of each."""
    taken = dict.fromkeys(works, float("inf"))
    for _ in range(rounds):
        for name, work in works.items():
            began = time.perf_counter()
            work()
            taken[name] = min(taken[name], (time.perf_counter() - began) * 1e3)
    return taken


def measure(nodes: int, rounds: int, dialect: int) -> None:
    """Prints the figures of one dialect."""
    text, vocabulary = five_thousand(nodes, dialect), world_vocabulary()
    source = Source(text)
    tree, element = read_xml(source), ElementTree.fromstring(text)
    with gc_paused:  # as in `parse_tree`
        taken = least(
            {
                "parse": partial(ElementTree.fromstring, text),
                "read": partial(read_xml, source),
                "serialise": partial(ElementTree.tostring, element, encoding="unicode"),
                "write": partial(to_xml, tree, vocabulary, dialect=dialect),
                "canonical": partial(to_xml, tree.replace(origin=None), vocabulary, dialect=dialect),
            },
            rounds,
        )
    parse, serialise = taken["parse"], taken["serialise"]
    both = (taken["read"] + taken["write"]) / (parse + serialise)
    count = sum(1 for _ in tree.walk())
    print(f"dialect {dialect}, {count:,} nodes, {len(text) // 1000} kB: ElementTree parses in {parse:.1f} ms, ", end="")
    print(
        f"serialises in {serialise:.1f} ms; read {taken['read']:.1f} ms ({taken['read'] / parse:.2f} times), ", end=""
    )
    print(f"written {taken['write']:.1f} ms ({taken['write'] / serialise:.2f} times), ", end="")
    print(f"without its origin {taken['canonical']:.1f} ms ({taken['canonical'] / serialise:.2f} times); ", end="")
    print(f"both together {both:.2f} times")


def main() -> None:
    """Measures and prints."""
    options = argparse.ArgumentParser(description="How fast XML is read and written.")
    options.add_argument("--rounds", type=int, default=25)
    options.add_argument("--nodes", type=int, default=5000)
    chosen = options.parse_args()
    for dialect in (4, 3):
        measure(chosen.nodes, chosen.rounds, dialect)


if __name__ == "__main__":
    main()
