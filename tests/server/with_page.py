"""A command of btlang that has a page, whether it is built or not."""

from __future__ import annotations

import sys
from pathlib import Path

import btlang
from btlang.cli import main
from btlang.server.page import local_page

if __name__ == "__main__":
    setattr(local_page, "PAGE", Path(btlang.__file__))  # noqa: B010
    sys.exit(main(sys.argv[1:]))
