"""How a command of RTron is shown: as one would type it beside the demo's packages."""

from contextlib import nullcontext
from types import SimpleNamespace

from rtron.demos.runtime.app_files import launch_file, other_packages, own_packages
from rtron.demos.runtime.environment import Begun
from rtron.demos.runtime.processes import Finished


def test_packages_are_told_apart(tmp_path):
    ran = nullcontext(lambda: Finished("/usr/bin/python -m rtron", 0, "done"))
    begun = SimpleNamespace(rtron_beside=lambda *_, codes: ran if codes == (0,) else None)
    words = ("instrument", launch_file(1), "-o", tmp_path / "guarded.launch", "--packages")
    done = Begun.rtron(begun, *words, own_packages(1), "--packages", other_packages(1))
    assert done.command == (
        "rtron instrument ros1/tb3_demo/launch/tb3_demo.launch -o guarded.launch "
        "--packages ros1 --packages others/ros1"
    )
