"""The plain page for browsers: log-in, the robots that are up, and the emergency stop. Nothing has to be built."""

from __future__ import annotations

from pathlib import Path

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.staticfiles import StaticFiles

from btlang.server.access import Access, AccessError

_FOLDER = Path(__file__).parent / "page"
_POLICY = {
    "content-security-policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; frame-ancestors 'none';"
        " base-uri 'none'; form-action 'self'"
    )
}


def page_routes(access: Access) -> list[BaseRoute]:
    """Those that browsers ask for; who isn't logged in is led to the log-in."""

    async def index(request: Request) -> Response:
        try:
            await access.identify(request.headers, changes=False)
        except AccessError:
            return RedirectResponse("/login", 303)
        return _html("index.html")

    return [
        Route("/", index),
        Route("/login", lambda request: _html("login.html")),
        Mount("/page", StaticFiles(directory=_FOLDER)),
    ]


def _html(name: str) -> Response:
    return Response((_FOLDER / name).read_bytes(), media_type="text/html", headers=_POLICY)
