"""From the app to the guarded app, with RTron's own commands: scan, plan, check, instrument.

Decisions are plain data with the words of the plan's file. What they do not mention stays as it
was proposed.

{"app": "tb3_demo",
     "grcn": {"/cmd_vel": {"policy": "Preemption", "flows": {"/move_base": {"priority": 2}}}},
     "rsrcn": {"policy": "Constrain", "max_vel_limit": "0.22 m/s", "vflows": ["/control/max_vel"]},
     "msrcn": {"aflows": ["/goal"], "areas": […], "rules": […]},
     "fps_monitor": [{"node": "/recogniser", "topic": "/detect/objects"}],
     "clients": {"/teleop/cmd_vel": ["/bridge/assistant"]},
     "leases": […], "incidents": {…}}

`flows` of a GRCN are by publisher. `vflows` and `aflows` name those that are left of the proposed.
`clients` are nodes that no scan sees, since they come over a bridge; each gets a flow on a topic.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from rtron.demos.runtime.environment import DemoEnvironment
from rtron.demos.runtime.isolation import first_party_packages, launch_file, third_party_packages
from rtron.demos.runtime.processes import CompletedCommand
from rtron.errors import InputError
from rtron.planning.plan_file.loader import parse_plan, read_text
from rtron.planning.plan_file.writer import write_plan

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


PlanSection = dict[str, Any]
_FLOWS = {"rsrcn": "vflows", "msrcn": "aflows"}
_WHOLE = ("app", "leases", "incidents")
_COMMAND = {"domain": "Control", "kind": "command", "sharing": "contend"}


def write_decided_plan(plan: Path, out: Path, decisions: Mapping[str, Any]) -> None:
    """Write `plan` with the decisions in it to `out`.

    InputError if a decision names what the plan does not have, PlanError if no plan comes out.
    """
    decided = yaml.safe_load(read_text(plan))
    apply_decisions(decided, plain_copy(decisions))
    text = yaml.safe_dump(plain_copy(decided), sort_keys=False)
    out.write_text(write_plan(parse_plan(text, str(out))), encoding="utf-8")


def plain_copy(data: Any) -> Any:  # noqa: ANN401 - JSON
    """Return a copy in which nothing occurs in two places: as YAML it has no aliases."""
    return json.loads(json.dumps(data))


def apply_decisions(plan: PlanSection, decisions: PlanSection) -> None:
    """Change a plan, as its file has it, by the decisions."""
    for topic, clients in decisions.get("clients", {}).items():
        _add_clients(plan, topic, clients)
    for topic, decision in decisions.get("grcn", {}).items():
        grcn = _entry(plan["grcn"], "topic", topic)
        for publisher, change in decision.pop("flows", {}).items():
            _entry(grcn["flows"], "publisher", publisher).update(change)
        grcn.update({"mode": "enforce", **decision})
    for kind in _FLOWS.keys() & decisions.keys():
        _decide_node(plan[kind], _FLOWS[kind], decisions[kind])
    if "fps_monitor" in decisions:
        plan["fps_monitor"] = [
            _entry(plan["fps_monitor"], "node", each["node"]) | each
            for each in decisions["fps_monitor"]
        ]
    plan.update({name: decisions[name] for name in _WHOLE if name in decisions})


def _add_clients(plan: PlanSection, topic: str, clients: Sequence[str]) -> None:
    """Let clients publish a topic of the MSRCN, which gets a GRCN."""
    aflow = _entry(plan["msrcn"]["aflows"], "topic", topic)
    aflow["flows"] += [{"name": node.rpartition("/")[2], "publisher": node} for node in clients]
    added = {"id": f"grcn{topic.replace('/', '_')}", **_COMMAND, **aflow}
    plan["grcn"].append(plain_copy(added))


def _decide_node(node: PlanSection, flows: str, decision: PlanSection) -> None:
    """Change the RSRCN or MSRCN; of its topics those stay that the decision names."""
    guarded = [_entry(node[flows], "topic", topic) for topic in decision[flows]]
    node.update({"mode": "enforce", **decision, flows: guarded})


def _entry(entries: Sequence[PlanSection], key: str, value: str) -> PlanSection:
    for entry in entries:
        if entry[key] == value:
            return entry
    raise InputError(f"the plan has no {key} {value}", help="`rtron plan` shows what it has")
