"""The playground in a browser, from the site as it's built."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from tests.profiles import only_long
from tests.web.packages import ROOT, installed, node

HERE = Path(__file__).parent


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, format: str, *args: object) -> None:
        """Say nothing of requests."""


class _Server(ThreadingHTTPServer):
    def handle_error(self, request: object, client_address: object) -> None:
        """Say nothing of a browser that has gone on to another page."""


@contextmanager
def site_server(folder: Path) -> Iterator[str]:
    """The address of a folder's files, on this computer."""
    server = _Server(("127.0.0.1", 0), partial(_Quiet, directory=str(folder)))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@only_long
def test_somebody_tries_it(tmp_path: Path) -> None:
    packages = installed(HERE)  # skips without npm
    site = tmp_path / "site"
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--site-dir", str(site)],
        cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT), "NO_MKDOCS_2_WARNING": "1"}, text=True, check=False,
        stderr=subprocess.PIPE,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "isn't built" not in done.stderr, done.stderr
    pictures = Path(os.environ.get("PICTURES", tmp_path))
    with site_server(site) as address:
        print(node(HERE / "playground.mjs", address, str(pictures), folder=packages, seconds=240.0))
