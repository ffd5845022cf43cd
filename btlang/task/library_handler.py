"""What commands about the library do: a part of the message handler."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from btlang.api import Mission
from btlang.robots.bodies.body_file import read_body
from btlang.robots.worlds.world_file import read_world
from btlang.task import messages
from btlang.task.answers import deleted, outdated, revision_data
from btlang.task.checks import HIGHEST, choice, refused
from btlang.task.messages import Answer, wrong
from btlang.task.moments import shown
from btlang.task.store import Store
from btlang.task.task import Kind, MissionText
from btlang.text.escaping import one_line
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.diagnostics.errors import MissionError
    from btlang.robots.bodies.body import Body
    from btlang.task.task import Revision

MOST_CHARACTERS = 200_000
"""Of a text from others that isn't a mission; a world or robot file takes some seconds to read at most."""
_LONGEST_NAME = 200
_CALLED = {Kind.MISSION: "mission", Kind.WORLD: "world", Kind.ROBOT: "robot file", Kind.TEST: "test file"}


class LibraryHandler:
    """Its methods are those of btlang.task.handler.Handler. `admit` reads a mission as it does there; worlds have to
    leave room for `body`, if it's known; robot files may name nothing but one of `overs` to run on. Tests aren't read:
    somebody may write them before the mission that they run.
    """

    def __init__(
        self,
        store: Store,
        admit: Callable[[MissionText], Mission],
        now: Callable[[], float],
        body: Body | None,
        overs: Collection[str],
    ) -> None:
        self._store, self._admit, self._now, self._body, self._overs = store, admit, now, body, overs

    def put(self, command: messages.Put, person: str) -> Answer:
        """A new revision of a text that the robot can use."""
        name, kind = command.name, choice(Kind, command.kind, "kind", command.tag)
        if not name.strip() or "/" in name or not name.isprintable() or len(name) > _LONGEST_NAME:
            reason = f"a name of at most {_LONGEST_NAME} characters, without '/', that can be shown"
            raise wrong(command.tag, f"'name' must be {reason}")
        self._check(kind, name, command.text)
        kept = self._store.put_text(name, command.text, person, self._now(), command.revision, kind)
        if kept is None:
            return outdated(command, _CALLED[kind], self._store.text(name, kind=kind))
        text = f"'{one_line(kept.name)}' is in the library, revision {kept.number}."
        return Answer(True, text, {kind: revision_data(kept)})

    def delete(self, command: messages.Delete, person: str) -> Answer:
        """Takes a text out."""
        kind = choice(Kind, command.kind, "kind", command.tag)
        if not self._store.delete_text(command.name, person, self._now(), kind):
            raise unknown(command.name, kind)
        missions = [] if kind is not Kind.MISSION else self._store.schedules()
        left = [each.id for each in missions if each.mission.revision and each.mission.name == command.name]
        return Answer(True, deleted(command.name, left), {"schedules": left})

    def list(self, command: messages.Library, person: str) -> Answer:
        """All texts of a kind, or what there is of one."""
        kind = choice(Kind, command.kind, "kind", command.tag)
        found = self._found(command, kind)
        now = self._now()
        lines = [
            f"{one_line(each.name)}, revision {each.number}: {one_line(each.person)}, {shown(each.time, now)}"
            + (", deleted" if each.deleted else "")
            for each in found
        ]
        data = [{**revision_data(each), "text": each.text} for each in found]
        if command.name and not found:
            raise unknown(command.name, kind)
        empty = "The library is empty." if kind is Kind.MISSION else f"The library has no {_CALLED[kind]}s."
        return Answer(True, "\n".join(lines) or empty, {f"{kind}s": data})

    def _found(self, command: messages.Library, kind: Kind) -> Sequence[Revision]:
        if not command.name:
            return self._store.texts(kind)
        if command.revision is None:
            return self._store.revisions(command.name, kind)
        found = self._store.text(command.name, command.revision, kind) if command.revision <= HIGHEST else None
        return [] if found is None else [found]

    def _check(self, kind: Kind, name: str, text: str) -> None:
        """Raises MissionError with what is wrong with a text. Reads only the text, and runs nothing."""
        if kind is Kind.MISSION:
            self._admit(MissionText(text, name))
            return
        if len(text) > MOST_CHARACTERS:
            raise wrong("put", f"a {_CALLED[kind]} may have at most {MOST_CHARACTERS:,} characters")
        if kind is Kind.TEST:
            return
        source = Source(text, one_line(name), roots=())
        if kind is Kind.ROBOT:
            read_body(source, self._overs)
            return
        read_world(source, self._body)


def kept_text(store: Store, name: str, kind: Kind) -> Source:
    """The newest revision of a world or robot file. Raises MissionError (BT187) if there's none."""
    found = store.text(name, kind=kind)
    if found is None:
        raise unknown(name, kind)
    return Source(found.text, one_line(name), roots=())


def unknown(name: str, kind: Kind = Kind.MISSION, is_asked_for: bool = False) -> MissionError:
    """BT187: there's no such text. One that `is_asked_for` as a task may be meant as the mission itself."""
    reason = "isn't in the library"
    if is_asked_for and " " in name:
        reason += f"; to give a mission as text, write -c before it: btc task add -c '{one_line(name)}'"
    return refused(f"The {_CALLED[kind]} '{name}'", reason)
