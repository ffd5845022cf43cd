"""Components that go wrong once, when a file beside them says so."""

import os
import random
import subprocess
import sys
import time
from pathlib import Path

from btlang import Component

HERE = Path(__file__).parent


class Member(Component):
    def configure(self):
        subprocess.Popen(["sleep", "1000"])  # which nobody must have to look for
        plan = HERE / f"{self.name}.plan"
        what = plan.read_text(encoding="utf-8") if plan.exists() else ""
        plan.unlink(missing_ok=True)
        if what == "raise":
            raise RuntimeError("not today")
        if what == "hang":
            time.sleep(1000)
        if what == "lose":
            lose_answers(0.2)

    def roll(self, robot):
        robot.drive(0.3, 0.0)
        while True:
            yield


def lose_answers(share):
    """From now on a share of what this process says is never sent."""
    worker = sys.modules["__main__"].Worker
    send = worker.send

    def lossy(self, message):
        if random.random() >= share:
            send(self, message)

    worker.send = lossy
    os.environ["LOSES"] = str(share)


for number in range(20):
    vars()[f"Member{number}"] = type(f"Member{number}", (Member,), {})
