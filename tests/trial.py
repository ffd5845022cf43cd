"""A mission that a test runs, controls from within and looks at afterwards."""

from __future__ import annotations

from typing import Any

from btlang import Mission, Outcome, Run, Session, parse_tree
from btlang.run.controls import Controls


class Trial:
    """Each run is in a session of its own, as with Mission.run, unless one is given. `controls` are those of the run
    under way, else of the next one.
    """

    def __init__(self, mission: Mission | str, session: Session | None = None, **options: Any) -> None:
        self.mission = parse_tree(mission, **options) if isinstance(mission, str) else mission
        self.controls = Controls()
        self.latest: Run | None = None
        self._by_hand = False
        self._given = session
        self._session = session

    def run(self, *, robot: Any = "simulated", **options: Any) -> Outcome:
        """Runs to the end."""
        try:
            return self._prepared(robot, **options).execute()
        finally:
            self.controls = Controls(self.robot)
            if self._given is None and self._session is not None:
                self._session.connection.close()

    def tick(self) -> int:
        """By hand, in a run that goes on until `run` begins another one."""
        if not self._by_hand:
            self._prepared("simulated", speed="max")
            self._by_hand = True
        assert self.latest is not None
        return self.latest.tick()

    def halt(self) -> None:
        """Of the run that is ticked by hand."""
        if self.latest is not None:
            self.latest.halt()

    @property
    def robot(self) -> Any:
        """That of the latest run; where there was none, one at the start of its world."""
        if self._session is None:
            self._session = Session(world=self.mission.world)
        return self._session.robot

    def why(self) -> str:
        """Of the latest run."""
        return "" if self.latest is None else self.latest.why()

    @property
    def sink_errors(self) -> list[Exception]:
        """Of the latest run."""
        return [] if self.latest is None else self.latest.sink_errors

    def _prepared(self, robot: Any, **options: Any) -> Run:
        if self._given is None:
            self._session = Session(robot, world=self.mission.world)
        assert self._session is not None
        self._by_hand = False
        self.latest = self._session.prepare(self.mission, controls=self.controls, **options)
        return self.latest
