"""What `btc components` does."""

from __future__ import annotations

from btlang.task import messages
from btlang.task.client import Client
from btlang.task.command import print_answer

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def serve(options: argparse.Namespace) -> int:
    """Does the verb `components`; returns the exit code."""
    if (options.act == "list") == bool(options.item):
        raise messages.wrong(options.act, "it takes no name" if options.item else "it needs the name of a component")
    command = messages.Components() if options.act == "list" else messages.ChangeComponent(options.item, options.act)
    with Client(options.name) as client:
        return print_answer(client.send(command), options.json)
