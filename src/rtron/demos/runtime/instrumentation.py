"""From the app to the guarded app, with RTron's own commands: scan, plan, check, instrument."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rtron.demos.runtime.app_files import launch_file, other_packages, own_packages
from rtron.demos.runtime.environment import Begun
from rtron.demos.runtime.plan_edits import decide
from rtron.demos.runtime.processes import Finished

_FOUND = (0, 1)
"""A scan ends with 1 when it found risks."""


@dataclass(slots=True)
class Pipeline:
    """Makes the guarded launch in `folder`; `said` is what each command was and printed.

    The decisions are the developer's, who edits the proposed plan.
    """

    begun: Begun
    folder: Path
    said: list[Finished] = field(default_factory=list)

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
    def guarded(self) -> Path:
        """The launch file that starts the guarded app."""
        kind = ".launch" if self.begun.ros == 1 else ".launch.xml"
        return self.folder / f"guarded{kind}"

    def scan(self) -> None:
        """Read the app from its launch files and source; nothing of it need run."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._rtron("scan", *self._app(), "--format", "graph", "-o", self.graph, codes=_FOUND)
        self._rtron("scan", self.graph, codes=_FOUND)

    def guard(self, decisions: Mapping[str, Any]) -> Path:
        """Plan, decide, check and instrument; return the launch file of the guarded app."""
        self._rtron("plan", self.graph, "-o", self.proposed)
        decide(self.proposed, self.plan, decisions)
        self._rtron("check", self.plan, "--graph", self.graph)
        folders = (own_packages(self.begun.ros), other_packages(self.begun.ros))
        where = [word for folder in folders for word in ("--packages", folder)]
        launch = launch_file(self.begun.ros)
        self._rtron("instrument", launch, "--plan", self.plan, "-o", self.guarded, *where)
        return self.guarded

    def _app(self) -> Sequence[str | Path]:
        """Return how `rtron scan` is told of the app.

        In ROS 1 the third-party packages are found by ROS_PACKAGE_PATH, which makes them so.
        """
        ros = self.begun.ros
        folders = [own_packages(1)] if ros == 1 else [own_packages(2), other_packages(2)]
        return (*folders, "--launch", launch_file(ros))

    def _rtron(self, *words: str | Path, codes: Sequence[int] = (0,)) -> None:
        self.said.append(self.begun.rtron(*words, codes=codes))
