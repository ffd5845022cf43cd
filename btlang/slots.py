"""Types of slots for the annotations of functions that are words: `def cheer(person: Person, far: Length)`.

Each is a str or a float for Python, and names the type of the slot. A type of your own keyword file is written
`Annotated[str, "tool"]`. Quantities are in the unit in the comment.
"""

from __future__ import annotations

from typing import Annotated, TypeAlias

Person: TypeAlias = Annotated[str, "person"]
Place: TypeAlias = Annotated[str, "place"]
Object: TypeAlias = Annotated[str, "object"]
Door: TypeAlias = Annotated[str, "door"]
Zone: TypeAlias = Annotated[str, "zone"]
Color: TypeAlias = Annotated[str, "color"]
Text: TypeAlias = Annotated[str, "text"]
Length: TypeAlias = Annotated[float, "length"]  # m
Angle: TypeAlias = Annotated[float, "angle"]  # degrees
Duration: TypeAlias = Annotated[float, "duration"]  # s
Speed: TypeAlias = Annotated[float, "speed"]  # m/s
Percent: TypeAlias = Annotated[float, "percent"]
