"""How a command of RTron is shown: as one would type it beside the demo's packages."""

from types import SimpleNamespace

from rtron.demos.launching.apps import launch_file, other_packages, own_packages
from rtron.demos.launching.processes import Finished
from rtron.demos.launching.run import Begun


def test_packages_are_told_apart(tmp_path):
    class Ran:
        def finish(self, command, _environ, _codes, name):
            return Finished(f"{name} {command[-1]}", 0, "done")

    begun = SimpleNamespace(python="python", environ={}, processes=Ran())
    words = ("instrument", launch_file(1), "-o", tmp_path / "guarded.launch", "--packages")
    done = Begun.rtron(begun, *words, own_packages(1), "--packages", other_packages(1))
    assert done.command == (
        "rtron instrument ros1/tb3_demo/launch/tb3_demo.launch -o guarded.launch "
        "--packages ros1 --packages others/ros1"
    )
