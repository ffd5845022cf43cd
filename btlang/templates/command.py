"""What `btc new` does."""

from __future__ import annotations

from btlang.templates.project import make_project
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def serve(options: argparse.Namespace) -> int:
    """Does the verb `new`; returns the exit code. Raises MissionError (BT009)."""
    show("\n".join(make_project(options.kind, options.name)))
    show(f"\nGo on in the folder {options.name}: its README.md says how to try it.")
    return 0
