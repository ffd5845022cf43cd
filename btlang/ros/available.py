"""Checks whether ROS 2 is installed. Imports no ROS, so that it can be used anywhere."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.text.source import Source, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

OWN = Path(__file__).parent / "btlang_interfaces"
"""The package of btlang's own interfaces."""
_INSTALL = "Install it: pip install 'btlang[ros]', or source your ROS 2 Jazzy: . /opt/ros/jazzy/setup.bash"


def require_ros(*packages: str) -> None:
    """Raise MissionError (BT100) if rclpy, or one of the message packages named, can't be imported."""
    for package in ("rclpy", *packages):
        try:
            import_module(package)
        except ImportError as error:
            absent = error.name is not None and error.name.partition(".")[0] == package
            raise unusable(f"there is no Python package {package}" if absent else str(error), _INSTALL) from None


def require_package(package: str) -> None:
    """Raise MissionError (BT100) if there is no such Python package. Imports nothing."""
    if find_spec(package) is None:
        raise unusable(f"there is no Python package {package}", _INSTALL)


def require_interfaces() -> None:
    """Raise MissionError (BT110) if btlang's interfaces aren't compiled, or were for another Python or btlang."""
    reason = ""
    try:
        import_module(OWN.name)
        for path in sorted(OWN.glob("*/*.*")):
            kinds = import_module(f"{OWN.name}.{path.parent.name}")  # where it is for another Python, this fails
            if not hasattr(kinds, path.stem):
                reason = f"there is no {path.stem} in {OWN.name}, which is that of another btlang"
                break
    except ImportError as error:
        absent = (error.name or "").partition(".")[0] == OWN.name
        reason = f"there is no Python package {error.name}" if absent else str(error)
    if reason:
        raise MissionError([diagnostic("BT110", Span(Source("", "ROS 2"), 0, 0), reason=reason)])


def optional_interface(name: str) -> Any:
    """Return the class of an interface, such as "nav2_msgs/msg/SpeedLimit"; None if it isn't installed."""
    package, kind, cls = name.split("/")
    try:
        return getattr(import_module(f"{package}.{kind}"), cls, None)
    except ImportError:
        return None


def unusable(reason: str, advice: str = "") -> MissionError:
    """Return the error to raise if ROS 2 is missing or doesn't start (BT100)."""
    why = reason.strip().rstrip(".")
    return MissionError([diagnostic("BT100", Span(Source("", "ROS 2"), 0, 0), reason=why, advice=advice)])
