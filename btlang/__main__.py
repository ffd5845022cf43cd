"""`python -m btlang` is `btc`."""

import sys

from btlang.cli import main

sys.exit(main())
