"""From the app to the guarded app, with RTron's own commands: scan, plan, check, instrument."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rtron.demos.runtime.app_files import first_party_packages, launch_file, third_party_packages
from rtron.demos.runtime.environment import DemoEnvironment
from rtron.demos.runtime.plan_edits import write_decided_plan
from rtron.demos.runtime.processes import CompletedCommand

_SCAN_EXIT_CODES = (0, 1)
"""A scan ends with 1 when it found risks."""


@dataclass(slots=True)
class InstrumentationPipeline:
    """Makes the guarded launch in `folder`; `commands` is what each command was and printed.

    The decisions are the developer's, who edits the proposed plan.
    """

    environment: DemoEnvironment
    folder: Path
    commands: list[CompletedCommand] = field(default_factory=list)

    @property
    def graph(self) -> Path:
        """The app's interaction graph."""
        return self.folder / "graph.json"

    @property
    def proposed(self) -> Path:
        """The plan that RTron proposes."""
        return self.folder / "proposed.yaml"

    @property
    def plan(self) -> Path:
        """The plan with the developer's decisions."""
        return self.folder / "rtron.yaml"

    @property
    def guarded_launch(self) -> Path:
        """The launch file that starts the guarded app."""
        kind = ".launch" if self.environment.ros == 1 else ".launch.xml"
        return self.folder / f"guarded{kind}"

    def scan(self) -> None:
        """Read the app from its launch files and source; nothing of it need run."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._rtron(
            "scan",
            *self._scan_arguments(),
            "--format",
            "graph",
            "-o",
            self.graph,
            codes=_SCAN_EXIT_CODES,
        )
        self._rtron("scan", self.graph, codes=_SCAN_EXIT_CODES)

    def instrument(self, decisions: Mapping[str, Any]) -> Path:
        """Plan, decide, check and instrument; return the launch file of the guarded app."""
        self._rtron("plan", self.graph, "-o", self.proposed)
        write_decided_plan(self.proposed, self.plan, decisions)
        self._rtron("check", self.plan, "--graph", self.graph)
        folders = (
            first_party_packages(self.environment.ros),
            third_party_packages(self.environment.ros),
        )
        package_options = [word for folder in folders for word in ("--packages", folder)]
        launch = launch_file(self.environment.ros)
        self._rtron(
            "instrument", launch, "--plan", self.plan, "-o", self.guarded_launch, *package_options
        )
        return self.guarded_launch

    def _scan_arguments(self) -> Sequence[str | Path]:
        """Return how `rtron scan` is told of the app.

        In ROS 1 the third-party packages are found by ROS_PACKAGE_PATH, which makes them so.
        """
        ros = self.environment.ros
        folders = (
            [first_party_packages(1)]
            if ros == 1
            else [first_party_packages(2), third_party_packages(2)]
        )
        return (*folders, "--launch", launch_file(ros))

    def _rtron(self, *arguments: str | Path, codes: Sequence[int] = (0,)) -> None:
        self.commands.append(self.environment.run_rtron(*arguments, codes=codes))
