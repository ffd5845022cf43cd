"""What guests ask: the answers are in a file, and what isn't there is for the staff."""

from __future__ import annotations

import os
import re
import tomllib

from btlang import ActionFailed, Component, Parameter
from btlang.actions.speech import say

_ASKS = re.compile(r"(who|what|where|when|why|how|which|can|do|does|is|are|may)\b", re.IGNORECASE)


class Questions(Component):
    """Hears questions and answers them. One that the robot asked itself is answered elsewhere."""

    version = "1.0"
    file = Parameter("answers.toml", help="words of questions, and what the robot says; beside the robot file")

    def configure(self):
        """Reads the answers."""
        path = os.path.join(self.body.folder, os.path.basename(self.file))
        with open(path, "rb") as file:
            self._answers = tomllib.load(file)
        self._heard, self._open = 0, []

    def is_asked(self, robot):
        """Whether somebody has asked what the robot hasn't answered yet."""
        count = robot.ears.count
        for heard in robot.ears.since(min(self._heard, count)):
            if not robot.ears.asking and (heard.text.endswith("?") or _ASKS.match(heard.text)):
                self._open.append(heard.text)
        self._heard = count
        return bool(self._open)

    def answer(self, robot):
        """Answers all questions that it knows an answer to. Fails if there was another one."""
        unknown = []
        while self.is_asked(robot):
            question = self._open[0].lower()
            found = next((text for words, text in self._answers.items() if words in question), None)
            if found is None:
                unknown.append(question)
            else:
                yield from say(robot, found)
            self._open.pop(0)  # last: one that was interrupted is answered again
        if unknown:
            raise ActionFailed(f'I don\'t know an answer to "{unknown[0]}"')
