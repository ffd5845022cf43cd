"""The command `btc`, also as `python -m btlang`."""

from __future__ import annotations

import gc
import sys

_COLLECT_AFTER = (
    50_000  # new objects; Python's own 700 makes `btc check` a tenth slower, and none of its objects are garbage
)


def main() -> int:
    """Run the command; return its exit code. Ctrl-C is no traceback, not even while modules are imported."""
    gc.set_threshold(_COLLECT_AFTER)
    try:
        from btlang.cli import main as run

        return run()
    except KeyboardInterrupt:
        return 130
    finally:
        gc.freeze()  # else Python looks through all objects as it ends, which is a fifth of `btc check`


if __name__ == "__main__":
    sys.exit(main())
