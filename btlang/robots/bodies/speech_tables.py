"""The tables `voice`, `mouth` and `ears` of robot files, and the engine and recogniser that they name."""

from __future__ import annotations

from btlang.robots.bodies.body import EarsSpec, Mouth, VoiceSpec
from btlang.robots.files import class_of
from btlang.speech.engine import Estimate, MissingEngine, Settings, SpeechError
from btlang.speech.recogniser import RecogniserError, RecogniserSettings

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.bodies.body import Body
    from btlang.speech.engine import SpeechEngine
    from btlang.speech.recogniser import Recogniser
    from btlang.text.toml_table import Table


ESPEAK = "espeak"
_FOREIGN = 'only "{}" may be the engine of a robot file that isn\'t on this computer: others run code'
POCKETSPHINX = "pocketsphinx"


def read_voice(top: Table, may_load: bool) -> VoiceSpec | None:
    """Read the voice of a robot, None if it has none. With `may_load` any engine is allowed. Raises Problem."""
    if not top.has("voice"):
        return None
    table = top.table("voice")
    engine = table.text("engine") if table.has("engine") else ""
    if engine not in ("", ESPEAK) and not may_load:
        raise table.problem("engine", _FOREIGN.format(ESPEAK))
    usual = Settings()
    text = table.number("text", usual.text if engine else None, low=0.0)
    character = table.number("character", usual.character if engine else None, low=0.0)
    language = table.text("language") if engine and table.has("language") else usual.language
    variant = table.text("variant") if engine and table.has("variant") else ""
    speed = table.number("speed", usual.speed, low=80, high=450) if engine else usual.speed
    pitch = table.number("pitch", usual.pitch, low=0, high=100) if engine else usual.pitch
    return table.finish(VoiceSpec(Settings(language, variant, speed, pitch, text, character), engine))


def read_mouth(top: Table, body: Body) -> Mouth | None:
    """Read the mouth of a robot, None if it has none. Raises Problem for an unknown joint or display."""
    if not top.has("mouth"):
        return None
    table = top.table("mouth")
    joints = tuple(joint.name for joint in body.joints)
    displays = tuple(device.name for device in body.devices if device.kind == "display")
    joint = table.choice("joint", joints) if table.has("joint") else ""
    display = table.choice("display", displays) if table.has("display") else ""
    if not (joint or display):
        raise top.problem("mouth", 'a mouth is a "joint" or a "display"; write mouth = { joint = "jaw" }')
    return table.finish(Mouth(joint, display))


def engine_of(body: Body, language: str = "", may_estimate: bool = False) -> SpeechEngine:
    """Return the engine that a body's voice names, by default in its own language.

    Without an engine, or with `may_estimate` if it isn't installed, it is one without sound. Raises SpeechError.
    """
    voice = body.voice or VoiceSpec(Settings())
    settings = voice.settings.replace(language=language) if language else voice.settings
    if not voice.engine:
        return Estimate(settings)
    if voice.engine == ESPEAK:
        from btlang.speech.espeak import Espeak

        try:
            return Espeak(settings)
        except MissingEngine:
            if not may_estimate:
                raise
            return Estimate(settings)
    try:
        make = class_of(voice.engine, "btlang.speech", body.folder, "an engine of speech", "my_voice:Voice")
    except ValueError as problem:
        raise SpeechError(str(problem)) from problem
    engine: SpeechEngine = make(settings)
    return engine


def read_ears(top: Table, may_load: bool) -> EarsSpec | None:
    """Read the ears of a robot, None if it has none. With `may_load` any engine is allowed. Raises Problem."""
    if not top.has("ears"):
        return None
    table = top.table("ears")
    within, engine = table.number("within", low=0.001), table.text("engine") if table.has("engine") else ""
    if engine not in ("", POCKETSPHINX) and not may_load:
        raise table.problem("engine", _FOREIGN.format(POCKETSPHINX))
    if not engine:
        return table.finish(EarsSpec(within))
    language = table.text("language") if table.has("language") else RecogniserSettings().language
    wake, push = table.text("wake") if table.has("wake") else "", table.flag("push")
    if wake and push:
        raise table.problem("push", 'ears have a "wake" word or "push", not both')
    return table.finish(EarsSpec(within, engine, RecogniserSettings(language, push), wake))


def recogniser_of(body: Body) -> Recogniser:
    """Return the recogniser that the ears of a body name. Raises RecogniserError."""
    assert body.ears is not None
    if body.ears.engine == POCKETSPHINX:
        from btlang.speech.pocketsphinx import PocketSphinx

        return PocketSphinx(body.ears.settings)
    try:
        make = class_of(body.ears.engine, "btlang.ears", body.folder, "a recogniser", "my_ears:Recogniser")
    except ValueError as problem:
        raise RecogniserError(str(problem)) from problem
    recogniser: Recogniser = make(body.ears.settings)
    return recogniser
