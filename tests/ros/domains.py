"""Domains of ROS 2 for tests that run at the same time."""

from __future__ import annotations

import fcntl
import random
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

_DOMAINS = range(1, 102)  # the ports of higher ones are among those that the system hands out


@contextmanager
def free_domain() -> Iterator[int]:
    """The number of a domain that no other test on this machine uses at the same time."""
    folder = Path(tempfile.gettempdir(), "btlang-ros-domains")
    folder.mkdir(exist_ok=True)
    with ExitStack() as stack:
        for number in random.sample(_DOMAINS, len(_DOMAINS)):
            file = stack.enter_context((folder / str(number)).open("w"))
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield number
            return
        pytest.fail("all domains are in use")
