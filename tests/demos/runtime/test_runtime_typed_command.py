"""How a command of RTron is shown: as one would type it beside the demo's packages."""

from types import SimpleNamespace

from rtron.demos.runtime.environment import DemoEnvironment
from rtron.demos.runtime.isolation import first_party_packages, launch_file, third_party_packages
from rtron.demos.runtime.processes import CompletedCommand


def test_packages_are_told_apart(tmp_path):
    ran = CompletedCommand("/usr/bin/python -m rtron", 0, "done")
    processes = SimpleNamespace(run_command=lambda *_, name: ran)
    environment = SimpleNamespace(python="/usr/bin/python", environ={}, processes=processes)
    words = ("instrument", launch_file(1), "-o", tmp_path / "guarded.launch", "--packages")
    done = DemoEnvironment.run_rtron(
        environment, *words, first_party_packages(1), "--packages", third_party_packages(1)
    )
    assert done.command == (
        "rtron instrument ros1/tb3_demo/launch/tb3_demo.launch -o guarded.launch "
        "--packages ros1 --packages third_party/ros1"
    )
