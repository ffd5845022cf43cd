"""`btc` among nodes that announce themselves every 0.1 s: what it hasn't found after 3 s isn't there."""

from __future__ import annotations

import sys

from btlang.__main__ import main

if __name__ == "__main__":
    if "run" in sys.argv[:2]:
        from btlang.ros.robot import connection

        connection._DISCOVERY = 3.0
    sys.exit(main())
