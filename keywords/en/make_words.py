"""Writes `english.words`, the words of correct English, and their licence, from Debian's package `scowl`.

    apt-get download scowl && dpkg -x scowl_*.deb FOLDER
    python keywords/en/make_words.py FOLDER

A correction never replaces one of them: see docs/messages.md. They are SCOWL's common words with their inflected forms
in American and British spelling, and common names; proper names of people matter, since one is no slip for another.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

WORDS = Path(__file__).with_name("english.words")
LICENCE = WORDS.with_name("english.words.license")
LEVELS = {"words": 40, "upper": 40, "proper-names": 50}
"""How common words of a category must be: SCOWL's levels go from 10, the most common, to 95."""

NEWER = (
    "app apps autopilot countertop countertops gripper grippers hoover hoovers hoovering lidar livestream reboot "
    "reboots rebooting selfie selfies smartphone smartphones undock undocks undocking waypoint waypoints"
)
"""Words that people say to robots, and that SCOWL takes for rare."""

NOTICE = "# Words of correct English from SCOWL. english.words.license says what may be done.\n"


def words(scowl: Path) -> set[str]:
    """In lower case, without forms in 's; single letters are no words but for `a` and `i`."""
    found = {"a", "i", *NEWER.split()}
    for file in scowl.iterdir():
        name = re.fullmatch(r"(?:english|american|british)-([a-z-]+)\.(\d+)", file.name)
        if name and int(name[2]) <= LEVELS.get(name[1], 0):
            listed = file.read_text(encoding="latin-1").lower().split()
            found.update(word for word in listed if re.fullmatch("[a-z]{2,}", word))
    return found


if __name__ == "__main__":
    share = Path(sys.argv[1], "usr", "share")
    made = sorted(words(share / "dict" / "scowl"))
    WORDS.write_text(NOTICE + "\n".join(made) + "\n", encoding="utf-8")
    LICENCE.write_bytes((share / "doc" / "scowl" / "copyright").read_bytes())
    sys.stdout.write(f"{WORDS.name} has {len(made)} words.\n")
