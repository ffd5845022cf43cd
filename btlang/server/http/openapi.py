"""The API as an OpenAPI document, made from the classes of commands and a table of the routes."""

from __future__ import annotations

from functools import cache

from btlang.editing.queries import TextQuery
from btlang.server.page.processes import ASKED
from btlang.task.commands.schema import schema
from btlang.task.store.records import LibraryKind

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

VERSION = "1"
_TEXT: dict[str, Any] = {"type": "string"}
_NUMBER: dict[str, Any] = {"type": "integer"}
_ROBOT: dict[str, Any] = {
    "name": "robot",
    "in": "query",
    "description": "Which robot, if several are up.",
    "schema": _TEXT,
}
_WITH: dict[str, Any] = {
    "name": "with",
    "in": "query",
    "required": True,
    "description": "The other recording.",
    "schema": _TEXT,
}
_TRAIL: list[dict[str, Any]] = [
    {"name": "filter", "in": "query", "description": "Words that an entry must have.", "schema": _TEXT},
    {"name": "failures", "in": "query", "description": "With true, only what failed.", "schema": {"type": "boolean"}},
    {"name": "limit", "in": "query", "description": "The most entries: 100 by default, up to 1000.", "schema": _NUMBER},
]
_NAME: dict[str, Any] = {"name": "name", "in": "path", "required": True, "schema": _TEXT}


def _object(*required: str, **properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "required": list(required)}


LIBRARY = {
    "/api/missions": LibraryKind.MISSION,
    "/api/worlds": LibraryKind.WORLD,
    "/api/robot-files": LibraryKind.ROBOT,
    "/api/tests": LibraryKind.TEST,
}
"""The contents of the library, by the paths of its routes."""
_WORLD = {"type": "string", "description": "The name of a world of the library, instead of the world of the robot."}
_PAGE = {"type": "string", "description": "Which page of a session asks; only its newest request of a kind waits."}
_PLACE = {"type": "integer", "minimum": 0, "description": "A place in the text, in UTF-16 units."}
_ARGUMENTS: dict[str, dict[str, Any]] = {
    "at": _PLACE,
    "to": _PLACE,
    "edit": _object(
        "do",
        "node",
        **dict.fromkeys(("node", "last", "to"), _NUMBER),
        **dict.fromkeys(("do", "place", "form", "port", "words"), _TEXT),
    ),
    "tests": {"type": "string", "description": "Tests, as a file of tests has them."},
    "called": {"type": "string", "description": "What the tests call the mission that they run."},
    "shown": {
        "type": "string",
        "description": 'The name of the document that a page has, "" for none: it then gets only what differs.',
    },
    "name": {"type": "string", "description": "The new name; without it, what would be renamed."},
}


def _written(query: TextQuery) -> dict[str, Any]:
    further = {name: _ARGUMENTS[name] for name in (*query.needs, *query.takes)}
    return _object("text", *query.needs, text=_TEXT, robot=_TEXT, world=_WORLD, page=_PAGE, **further)


def _library(path: str, called: str) -> dict[tuple[str, str], tuple[str, dict[str, Any] | None]]:
    return {
        ("GET", path): (f"The {called}s of the library.", None),
        ("GET", f"{path}/{{name}}"): (f"All revisions of a {called}.", None),
        ("PUT", f"{path}/{{name}}"): (
            f"Keeps a {called}; with the revision it was made from, 0 for a new one, nothing newer is overwritten.",
            _object("text", text=_TEXT, revision={"type": "integer"}),
        ),
        ("DELETE", f"{path}/{{name}}"): (f"Takes a {called} out of the library.", None),
    }


ROUTES: dict[tuple[str, str], tuple[str, dict[str, Any] | None]] = {
    ("POST", "/api/login"): ("Begins a session.", _object("name", "password", name=_TEXT, password=_TEXT)),
    ("POST", "/api/logout"): ("Ends a session, or all of a user.", _object(everywhere={"type": "boolean"})),
    ("GET", "/api/me"): ("Who asks.", None),
    ("GET", "/api/users"): ("The users with their roles and tokens, for administrators.", None),
    ("POST", "/api/users"): (
        "Changes a user, for administrators; the password must have been given in the last five minutes.",
        _object("act", "name", **dict.fromkeys(("act", "name", "role", "token"), _TEXT)),
    ),
    ("GET", "/api/trail"): ("What people did or tried, the newest first, for administrators.", None),
    ("POST", "/api/confirm"): ("Confirms the password before users are changed.", _object("password", password=_TEXT)),
    ("GET", "/api/robots"): ("The robots, and whether they are up.", None),
    ("POST", "/api/stop"): ("The emergency stop.", _object(robot=_TEXT, reason=_TEXT)),
    ("POST", "/api/commands"): ("A command for a robot.", {"$ref": "#/components/schemas/Command"}),
    **_library("/api/missions", "mission"),
    **_library("/api/worlds", "world"),
    **_library("/api/robot-files", "robot file"),
    **_library("/api/tests", "test file"),
    **{("POST", f"/api/{name}"): (query.help, _written(query)) for name, query in ASKED.items()},
    ("GET", "/api/recordings"): ("The recordings of a robot.", None),
    ("GET", "/api/recordings/{name}"): ("One, as MCAP.", None),
    ("GET", "/api/films/{name}"): ("One as data that a page plays.", None),
    ("GET", "/api/trees/{name}"): ("The tree of one as XML of BehaviorTree.CPP.", None),
    ("GET", "/api/failures/{name}"): ("What failed in the latest runs of its mission.", None),
    ("GET", "/api/comparisons/{name}"): ("Two as films, and what differs between them.", None),
    ("GET", "/api/urdf"): ("The body of a robot as URDF, an XML file; not of one without links.", None),
    ("GET", "/metrics"): ("Figures for Prometheus.", None),
    ("GET", "/live"): ("Whether the server is alive; without log-in.", None),
    ("GET", "/ready"): ("Whether it takes requests; without log-in.", None),
    ("GET", "/favicon.ico"): ("The icon of the page, as SVG; without log-in.", None),
    ("GET", "/openapi.json"): ("This document; without log-in.", None),
}
_RECORDED = ("/api/recordings", "/api/films", "/api/trees", "/api/failures", "/api/comparisons")
_OPEN = ("/api/login", "/live", "/ready", "/favicon.ico", "/openapi.json")


@cache
def document() -> dict[str, Any]:
    """Make the OpenAPI 3.1 document."""
    commands = {key: value for key, value in schema().items() if key != "$schema"}
    for each in commands["oneOf"]:
        each["properties"]["robot"] = _TEXT
    paths: dict[str, dict[str, Any]] = {}
    for (method, path), (summary, body) in ROUTES.items():
        described: dict[str, Any] = {"summary": summary, "responses": {"default": {"description": "JSON"}}}
        if body is not None:
            described["requestBody"] = {"required": True, "content": {"application/json": {"schema": body}}}
        parameters = [_NAME] if "{name}" in path else []
        parameters += [_ROBOT] if path.removesuffix("/{name}") in (*LIBRARY, *_RECORDED, "/api/urdf") else []
        parameters += _TRAIL if path == "/api/trail" else []
        parameters += [_WITH] if path.startswith("/api/comparisons") else []
        if parameters:
            described["parameters"] = parameters
        if path in _OPEN:
            described["security"] = []
        paths.setdefault(path, {})[method.lower()] = described
    schemes = {
        "token": {"type": "http", "scheme": "bearer"},
        "session": {"type": "apiKey", "in": "cookie", "name": "__Host-btlang"},
    }
    return {
        "openapi": "3.1.0",
        "info": {"title": "Robots of btlang", "version": VERSION},
        "paths": paths,
        "components": {"schemas": {"Command": commands}, "securitySchemes": schemes},
        "security": [{"token": []}, {"session": []}],
    }
