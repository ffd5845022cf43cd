"""The table `ears` of robot files, and the recogniser that it names."""

from __future__ import annotations

from btlang.robots.body import Ears
from btlang.robots.modules import class_of
from btlang.speech.recogniser import RecogniserError, RecogniserSettings

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.body import Body
    from btlang.speech.recogniser import Recogniser
    from btlang.text.toml_table import Table

ENTRY_POINTS = "btlang.ears"
POCKETSPHINX = "pocketsphinx"
_FOREIGN = f'only "{POCKETSPHINX}" may be the engine of a robot file that isn\'t on this computer: others run code'
_LEAST = 0.001


def read_ears(top: Table, may_load: bool) -> Ears | None:
    """The ears of a robot, None where it has none. With `may_load` any engine will do. Raises Problem."""
    if not top.has("ears"):
        return None
    table = top.table("ears")
    within, engine = table.number("within", low=_LEAST), table.text("engine") if table.has("engine") else ""
    if engine not in ("", POCKETSPHINX) and not may_load:
        raise table.problem("engine", _FOREIGN)
    if not engine:
        return table.finish(Ears(within))
    language = table.text("language") if table.has("language") else RecogniserSettings().language
    wake, push = table.text("wake") if table.has("wake") else "", table.flag("push")
    if wake and push:
        raise table.problem("push", 'ears have a "wake" word or "push", not both')
    return table.finish(Ears(within, engine, RecogniserSettings(language, push), wake))


def recogniser_of(body: Body) -> Recogniser:
    """The recogniser that the ears of a body name. Raises RecogniserError."""
    assert body.ears is not None
    if body.ears.engine == POCKETSPHINX:
        from btlang.speech.pocketsphinx import PocketSphinx

        return PocketSphinx(body.ears.settings)
    try:
        make = class_of(body.ears.engine, ENTRY_POINTS, body.folder, "a recogniser", "my_ears:Recogniser")
    except ValueError as problem:
        raise RecogniserError(str(problem)) from problem
    recogniser: Recogniser = make(body.ears.settings)
    return recogniser
