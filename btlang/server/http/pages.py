"""The page for browsers: that of `btlang/web` where it was built, else a plain one."""

from __future__ import annotations

import re
import secrets
from collections.abc import Callable
from pathlib import Path

from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from btlang.server.http.access import Access, AccessError, host_of

PLAIN = Path(__file__).parent / "plain_page"
BUILT = Path(__file__).parents[2] / "web" / "dist"
ICON = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 16 16"><rect width="16" height="16" rx="4" fill="#1d4ed8"/>'
    '<path d="M8 3v3M4 13V9h8v4M8 6v3" stroke="#fff" stroke-width="1.6" fill="none"/></svg>'
)
_HOST = re.compile(r"[0-9A-Za-z.:-]{1,253}")
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{nonce}'; img-src 'self' data:;"
    " connect-src 'self'{stop}; frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
)


def page_routes(access: Access, stop_port: Callable[[], int] = int, built: Path = BUILT) -> list[BaseRoute]:
    """Make the routes of pages that browsers ask for; who isn't logged in is led to the log-in.

    Pages may also reach `stop_port` of the same host, for the emergency stop.
    """
    is_built = (built / "index.html").is_file()
    folder, log_in = (built, "index.html") if is_built else (PLAIN, "login.html")

    def html(request: Request, name: str) -> Response:
        return _html(folder / name, _stop_source(request, stop_port()))

    async def index(request: Request) -> Response:
        try:
            await access.identify(request.headers, changes=False)
        except AccessError:
            return RedirectResponse("/login", 303)
        return html(request, "index.html")

    files = _HashedFiles(directory=built / "files") if is_built else StaticFiles(directory=PLAIN)
    return [
        Route("/", index),
        Route("/login", lambda request: html(request, log_in)),
        Route("/favicon.ico", lambda request: Response(ICON, media_type="image/svg+xml")),
        Mount("/page", GZipMiddleware(files)),
    ]


class _HashedFiles(StaticFiles):
    """The files with a hash in their names, which browsers may keep forever."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        response = await super().get_response(path, scope)
        if response.status_code == 200:
            response.headers["cache-control"] = "public, max-age=31536000, immutable"
        return response


def _stop_source(request: Request, port: int) -> str:
    """Return the source for the policy of a page that may reach the emergency stop."""
    host = host_of(request.headers.get("host", ""))
    if not port or not _HOST.fullmatch(host):
        return ""
    return f" {request.scope['scheme']}://{f'[{host}]' if ':' in host else host}:{port}"


def _html(path: Path, stop: str) -> Response:
    """Serve HTML with a nonce, which lets the editor of the page add its styles."""
    nonce = secrets.token_urlsafe(16)
    text = path.read_text(encoding="utf-8").replace("NONCE", nonce)
    policy = _POLICY.format(nonce=nonce, stop=stop)
    return Response(text, media_type="text/html", headers={"content-security-policy": policy})
