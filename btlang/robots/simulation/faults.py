"""What the world file says will go wrong, and when."""

from __future__ import annotations

from math import inf

from btlang.robots.worlds.world import NEVER, WorldFault, said


def describe(fault: WorldFault) -> str:
    """Return the fault in plain English."""
    if fault.kind == "blocked":
        return f"the way to {said(fault.place)} is blocked"
    if fault.kind == "slip":
        wheels = "both wheels slip" if fault.wheel == "both" else f"the {fault.wheel} wheel slips"
        return f"{wheels}: {fault.grip:.0%} grip"
    if fault.kind == "weak hand":
        return f"the {fault.hand} hand drops things after {fault.seconds:g} s"
    if fault.kind == "dock":
        times = "" if fault.times == NEVER else f" {fault.times:g} times"
        return f"{said(fault.place or 'dock')} doesn't connect{times}"
    return "the laser scanner is silent"


class Faults:
    """The faults that are active at the moment."""

    def __init__(self, faults: tuple[WorldFault, ...]) -> None:
        self._faults = faults
        self._active: tuple[WorldFault, ...] = ()
        self._failed: list[WorldFault] = []

    def advance(self, now: float) -> list[WorldFault]:
        """Move on to a second of the run; return the faults that began with it."""
        if not self._faults:
            return []
        before = self._active
        self._active = tuple(fault for fault in self._faults if fault.start <= now < fault.end)
        return [fault for fault in self._active if fault not in before]

    def begin(self, fault: WorldFault) -> None:
        """Add a fault to those of the world file, from the next `advance` on."""
        self._faults = (*self._faults, fault)

    def end(self, kind: str, place: str = "") -> None:
        """End all faults of a kind; of blocked ways, those to a place."""
        self._faults = tuple(fault for fault in self._faults if (fault.kind, fault.place) != (kind, place))
        self._active = tuple(fault for fault in self._active if fault in self._faults)

    def is_blocked(self, place: str) -> bool:
        """Return whether no way leads to the place."""
        return any(fault.kind == "blocked" and fault.place == place for fault in self._active)

    @property
    def grips(self) -> tuple[float, float]:
        """The share of their motion that the left and the right wheel bring to the floor, 0 to 1."""
        return (self._grip("left"), self._grip("right")) if self._active else (1.0, 1.0)

    def fails_to_dock(self, name: str) -> bool:
        """Return whether connecting to a dock fails this time: each call counts as one of the `times` of a fault."""
        failing = (
            each
            for each in self._active
            if each.kind == "dock" and each.place in ("", name) and self._failed.count(each) < each.times
        )
        self._failed += (found := [*failing][:1])
        return bool(found)

    @property
    def scanner_silent(self) -> bool:
        """Whether there are no scans."""
        return any(fault.kind == "silent scanner" for fault in self._active)

    def holds_for(self, hand: str) -> float:
        """Return the seconds until the hand drops what it grasped; inf for a sound one."""
        weak = (fault for fault in self._active if fault.kind == "weak hand" and fault.hand == hand)
        return min((fault.seconds for fault in weak), default=inf)

    def _grip(self, wheel: str) -> float:
        slipping = (fault for fault in self._active if fault.kind == "slip" and fault.wheel in (wheel, "both"))
        return min((fault.grip for fault in slipping), default=1.0)
