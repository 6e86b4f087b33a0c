"""Whether a launch file is of the ROS that a plan is for."""

from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_bounded
from rtron.vocabulary import Plan

_ROS1 = (".launch", ".test", ".xml")
_ROS2 = (".py", ".yaml", ".yml", ".xml")
_MAX_BYTES = 2**20
_MARKERS = {
    1: (b" type=", b"$(arg ", b"<rosparam"),
    2: (b" exec=", b"$(var ", b"$(find-pkg-share "),
}
"""What XML of one generation has and the other has not."""


def check_launch_generation(launch: Path, plan: Plan, path: str) -> None:
    """Raise InputError if a launch file is for another ROS than the plan, read from `path`."""
    other = 3 - plan.ros
    known = {1: _ROS1, 2: _ROS2}
    if launch.suffix in known[other] and launch.suffix not in known[plan.ros]:
        raise _wrong_generation(launch, plan, path)
    if launch.suffix in {".xml", ".launch"} and launch.is_file():
        text = read_bounded(launch, _MAX_BYTES)
        if _has_marker(text, other) and not _has_marker(text, plan.ros):
            raise _wrong_generation(launch, plan, path)


def _has_marker(text: bytes, ros: int) -> bool:
    return any(marker in text for marker in _MARKERS[ros])


def _wrong_generation(launch: Path, plan: Plan, path: str) -> InputError:
    help = f"{path} says `ros: {plan.ros}`; make a plan for ROS {3 - plan.ros}"
    return InputError(f"is no launch file of ROS {plan.ros}", path=str(launch), help=help)
