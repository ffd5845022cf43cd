"""The page for browsers: that of `btlang/web` where it was built, else a plain one."""

from __future__ import annotations

import secrets
from pathlib import Path

from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from btlang.server.http.access import Access, AccessError

PLAIN = Path(__file__).parent / "plain_page"
BUILT = Path(__file__).parents[2] / "web" / "dist"
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{nonce}'; img-src 'self' data:; connect-src 'self';"
    " frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
)


def page_routes(access: Access, built: Path = BUILT) -> list[BaseRoute]:
    """Make the routes of pages that browsers ask for; who isn't logged in is led to the log-in."""
    is_built = (built / "index.html").is_file()
    folder, log_in = (built, "index.html") if is_built else (PLAIN, "login.html")

    async def index(request: Request) -> Response:
        try:
            await access.identify(request.headers, changes=False)
        except AccessError:
            return RedirectResponse("/login", 303)
        return _html(folder / "index.html")

    files = _HashedFiles(directory=built / "files") if is_built else StaticFiles(directory=PLAIN)
    return [
        Route("/", index),
        Route("/login", lambda request: _html(folder / log_in)),
        Mount("/page", GZipMiddleware(files)),
    ]


class _HashedFiles(StaticFiles):
    """The files with a hash in their names, which browsers may keep forever."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        response = await super().get_response(path, scope)
        if response.status_code == 200:
            response.headers["cache-control"] = "public, max-age=31536000, immutable"
        return response


def _html(path: Path) -> Response:
    """Serve HTML with a nonce, which lets the editor of the page add its styles."""
    nonce = secrets.token_urlsafe(16)
    text = path.read_text(encoding="utf-8").replace("NONCE", nonce)
    return Response(text, media_type="text/html", headers={"content-security-policy": _POLICY.format(nonce=nonce)})
