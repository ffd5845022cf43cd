"""BT237: loops of no round at all, whose child never runs."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree.catalogue import CATALOGUE


def no_rounds(compilation: Compilation) -> Iterator[Diagnostic]:
    """Loops with a number of rounds that is 0. A number of retries may be 0: the first try is none."""
    loops = {id: CATALOGUE[id].rounds for id in compilation.ids if id in CATALOGUE and CATALOGUE[id].rounds}
    ports = {id: port for id, port in loops.items() if CATALOGUE[id].ports[port].unit == "rounds"}
    for _, nodes in compilation.nodes if ports else ():
        for node in nodes:
            port = ports.get(node.id)
            if port is not None and node.port(port) == "0" and node.span is not None:
                yield diagnostic("BT237", node.span, id=node.id, port=port)
