"""The command `btc`, also as `python -m btlang`."""

from __future__ import annotations

import sys


def main() -> int:
    """Runs the command; returns its exit code. Ctrl-C is no traceback, not even while modules are imported."""
    try:
        from btlang.cli import main as run

        return run()
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
