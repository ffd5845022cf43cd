"""One mission of the node, in a thread of its own."""

from __future__ import annotations

from collections.abc import Callable
from threading import Thread

from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.render import render
from btlang.engine.status import NAMES
from btlang.record import Record
from btlang.run.controls import Controls

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.api import Mission
    from btlang.run.events import Sink
    from btlang.run.runner import Outcome
    from btlang.session import Run, Session


class Report(Record):
    """How a mission ended, in words: `outcome` is "success", "failure", "skipped" or "stopped"."""

    outcome: str
    reason: str = ""
    seconds: float = 0.0

    @property
    def success(self) -> bool:
        """Whether it did what it should; a mission that had nothing to do did."""
        return self.outcome in ("success", "skipped")

    def __str__(self) -> str:
        told = {"success": "succeeded", "failure": "failed", "skipped": "had nothing to do", "stopped": "was stopped"}
        reason = f": {self.reason}" if self.reason else ""
        return f"the mission {told[self.outcome]} after {self.seconds:.1f} s{reason}"


class MissionThread:
    """Runs one mission in a session; begins at once, in its own thread, which compiles the mission too.

    `compiled` makes the mission, `sinks` what hears of its run from the start, and `watch` gets both before the run is
    under way. `ended` gets the report once the robot stands still. All of them are called in the thread of the run;
    `stop` and the like come from any.
    """

    def __init__(
        self,
        session: Session,
        compiled: Callable[[], Mission],
        sinks: Callable[[Mission], list[Sink]],
        watch: Callable[[Mission, Run], object],
        ended: Callable[[Report], object],
        speed: float | str = "real",
    ) -> None:
        self.over = False
        """Whether another mission may begin."""
        self.hangs = False
        """Whether it was told to end and did not."""
        self._controls = Controls(session.robot)
        self._session, self._speed = session, speed
        self._compiled, self._sinks, self._watch, self._ended = compiled, sinks, watch, ended
        self._thread = Thread(target=self._work, name="btlang mission", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Halts the mission and brings the robot to rest; waits for nothing."""
        self._controls.stop()

    def emergency_stop(self) -> None:
        """Stops the robot at once, in the thread of who asks, then ends the mission."""
        self._controls.emergency_stop()

    def join(self, seconds: float) -> bool:
        """Whether the run is over, `ended` included, within so many seconds."""
        self._thread.join(seconds)
        return not self._thread.is_alive()

    def _work(self) -> None:
        try:
            report = self._run()
        except MissionError as error:
            report = Report("failure", problems(error))
        except BaseException as error:  # nothing may end the node but its user, nor keep it busy for ever
            report = Report("failure", f"an error inside btlang: {error!r}")
        self.over = True
        self._ended(report)

    def _run(self) -> Report:
        mission = self._compiled()
        if self._controls.stopped:  # while it was compiled
            return Report("stopped", "emergency stop" if self._controls.emergency else "interrupted")
        sinks = self._sinks(mission)
        run = self._session.prepare(mission, speed=self._speed, controls=self._controls, sinks=sinks)
        self._watch(mission, run)
        return _report(run.execute())


def problems(error: MissionError) -> str:
    """All that is wrong, as `btc` tells it."""
    return "\n".join(render(diagnostic) for diagnostic in error.diagnostics)


def _report(outcome: Outcome) -> Report:
    ended = "stopped" if outcome.stopped else NAMES[outcome.status].lower()
    reason = outcome.stopped or outcome.why()
    if outcome.standstill.alarming:
        reason = f"{reason}\nWARNING: {outcome.standstill}".lstrip()
    return Report(ended, reason, outcome.seconds)
