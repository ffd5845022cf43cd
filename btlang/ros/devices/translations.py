"""What makes messages of each kind of device."""

from __future__ import annotations

from btlang.ros.devices.moving import DriveTranslation, HandTranslation, JointTranslation
from btlang.ros.devices.sensing import (
    BatteryTranslation,
    ButtonTranslation,
    CameraTranslation,
    ImuTranslation,
    LidarTranslation,
    RangeTranslation,
)
from btlang.ros.devices.showing import (
    DisplayTranslation,
    LightTranslation,
    MicrophoneTranslation,
    SpeakerTranslation,
)
from btlang.ros.devices.translation import Translation

TRANSLATIONS: dict[str, type[Translation]] = {
    "range": RangeTranslation,
    "lidar": LidarTranslation,
    "drive": DriveTranslation,
    "imu": ImuTranslation,
    "battery": BatteryTranslation,
    "joint": JointTranslation,
    "hand": HandTranslation,
    "camera": CameraTranslation,
    "microphone": MicrophoneTranslation,
    "speaker": SpeakerTranslation,
    "button": ButtonTranslation,
    "light": LightTranslation,
    "display": DisplayTranslation,
}
"""By the kinds of devices."""
