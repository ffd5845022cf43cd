"""The lifecycle node that runs missions: its own one, and those that other programs send."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from std_srvs.srv import Trigger

from btlang.api import Mission
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import read_included, read_source
from btlang.ros.mission.progress import News, Progress
from btlang.ros.mission.server import MissionServer
from btlang.ros.mission.setup import Setup
from btlang.ros.mission.thread import MissionThread, Report, problems
from btlang.ros.mission.topics import ERROR, OK, WARN, Topics
from btlang.ros.mission.tree_topic import TreeTopic
from btlang.run.lines import Lines
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.recording.recorder import Recorder
    from btlang.run.events import Sink
    from btlang.session import Run, Session

_SUCCESS, _FAILURE = TransitionCallbackReturn.SUCCESS, TransitionCallbackReturn.FAILURE
_END = 8.0  # seconds of real time that a mission gets to halt and to bring the robot to rest


class MissionNode(LifecycleNode):  # type: ignore[misc]  # rclpy is seen as untyped
    """configure compiles the mission of the parameters `mission` or `mission_file` and reaches for the robot; activate
    runs it; deactivate halts it; cleanup lets go of both.

    All of its callbacks are called in one thread; missions run in their own. `error` is why configuring failed.
    """

    def __init__(self, setup: Setup, show: Callable[[str], object], name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self._setup = setup
        self._session: Session | None = None
        self._source: Source | None = None
        self._run: MissionThread | None = None
        self._latest: Report | None = None
        self._running = ""
        self._active = False
        self.error: MissionError | None = None
        self.declare_parameter("mission", "")
        self._first_file: str = self.declare_parameter("mission_file", setup.file).value
        self._topics = Topics(self, show, self._health)
        self.create_service(Trigger, "~/stop", self._stop)
        self._server = MissionServer(self, self._hindrance, self._begin_goal, self._topics.complain)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Fails where the mission cannot be compiled or the robot cannot be reached; the log says why."""
        try:
            self._source = self._own_mission()
            if self._source is not None:
                self._setup.compiled(self._source)
            self._session = self._setup.session()
        except MissionError as error:
            self.error = error
            self._topics.complain(problems(error))
            return _FAILURE
        return _SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Runs the mission of the parameters where there is one; from now on takes missions of others."""
        self._active = True
        if self._source is not None:
            self._begin(self._source, (), lambda news: None, lambda report: None)
        return _SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Waits until the robot stands still. Fails where a command hangs; the robot is stopped all the same."""
        self._active = False
        if self.halt():
            return _SUCCESS
        self._active = True
        return _FAILURE

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Lets go of the robot."""
        self.release()
        return _SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """As deactivate and cleanup."""
        self._active = False
        self.halt()
        self.release()
        return _SUCCESS

    def halt(self) -> bool:
        """Halts the mission and waits a few seconds; whether it ended. From any thread."""
        if self._run is None:
            return True
        self._run.stop()
        if self._run.join(0.0 if self._run.hangs else _END):
            return True
        self._run.hangs = True  # who asks again need not wait again
        self._run.emergency_stop()
        self._topics.complain("the mission doesn't end because a command hangs; the robot was stopped")
        return False

    def release(self) -> None:
        """Lets go of the robot, at rest. May be called twice."""
        session, self._session = self._session, None
        if session is not None:
            session.close()

    def emergency_stop(self) -> bool:
        """Stops the robot at once and ends the mission, from any thread; False where there is no robot yet."""
        session, run = self._session, self._run
        if session is None:
            return False
        if run is not None and not run.over:
            run.emergency_stop()
        else:
            session.emergency_stop()
        return True

    def _stop(self, request: Any, response: Any) -> Any:
        response.success = self.emergency_stop()
        response.message = "" if response.success else "there is no robot: the node is not configured"
        return response

    @property
    def _busy(self) -> bool:
        return self._run is not None and not self._run.over

    def _hindrance(self) -> str:
        """Why no mission can begin now; "" where one can."""
        if not self._active:
            return "the node is not active"
        return "another mission is running" if self._busy else ""

    def _begin_goal(
        self, request: Any, changed: Callable[[News], object], ended: Callable[[Report], object]
    ) -> MissionThread:
        return self._begin(self._setup.sent(request.mission), request.keywords, changed, ended)

    def _begin(
        self,
        source: Source,
        keywords: Sequence[str],
        changed: Callable[[News], object],
        ended: Callable[[Report], object],
    ) -> MissionThread:
        assert self._session is not None

        recorders: list[Recorder] = []

        def sinks(mission: Mission) -> list[Sink]:
            try:
                recorder = self._setup.recorder(mission, keywords)
            except MissionError as error:  # a mission runs without its recording, too
                self._topics.complain(problems(error))
                recorder = None
            recorders.extend([recorder] if recorder is not None else [])
            return [Lines(mission.label, mission.is_action, self._topics.log), *recorders]

        def watch(mission: Mission, run: Run) -> None:
            tree = TreeTopic(mission, run, self._topics.tree, self._topics.tree_changes)

            def told(news: News) -> None:
                self._running = news.running
                tree.changed(news)
                changed(news)

            def reached(news: News) -> None:
                tree.reached(news, is_last=news.is_last)
                self._topics.status(news)

            run.bus.add(Progress(run.snapshot, told, reached))

        def over(report: Report) -> None:
            for recorder in recorders:
                recorder.close()
            self._latest, self._running = report, ""
            self._topics.log(str(report))
            ended(report)

        def compiled() -> Mission:
            self._setup.check_keywords(keywords)
            return self._setup.compiled(source, keywords)

        self._run = MissionThread(self._session, compiled, sinks, watch, over, self._setup.speed)
        return self._run

    def _own_mission(self) -> Source | None:
        text, file = (str(self.get_parameter(name).value) for name in ("mission", "mission_file"))
        if text:
            return self._setup.sent(text)
        if file == self._first_file:
            return read_source(file, self._setup.include_root) if file else None
        return read_included(file, self._setup.sent(""))  # any program may set a parameter

    def _health(self) -> tuple[bytes, str, dict[str, str]]:
        values = {"robot": self._setup.robot, "active": str(self._active), "running": self._running}
        if self._busy:
            return OK, "a mission is running", values
        if self._session is None:
            return WARN, "not configured", values
        if self._latest is None:
            return OK, "no mission has run yet", values
        level = ERROR if self._latest.outcome == "failure" else OK
        first, _, rest = str(self._latest).partition("\n")
        return level, first, {**values, "details": rest}
