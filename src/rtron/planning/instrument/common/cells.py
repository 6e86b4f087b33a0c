"""What a node needs that runs in a cell: its manifest, from graph and plan, and its script."""

import json
import re
import shlex
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field

from rtron.errors import InputError, suggestion
from rtron.messages.common.finite_numbers import NUMERIC_COMMAND_TYPES
from rtron.messages.common.velocity import VELOCITY_TYPES
from rtron.planning.app_topics import is_large
from rtron.planning.instrument.common.guarded_launch import PLAN_FILE
from rtron.planning.instrument.common.remaps import enforced_streams, private_names
from rtron.vocabulary import (
    CELL_SCHEMA,
    ROS1_CLIENT_TOPICS,
    ActionRole,
    CarriedService,
    CarriedTopic,
    CellManifest,
    Endpoint,
    InteractionGraph,
    Plan,
    Service,
    ServiceClient,
    build_streams,
    matches_node,
    may_pass,
    normalise_type,
    ros1_topic_name,
)

CELL_COMMAND = (sys.executable, "-m", "rtron", "cell")
_NOT_LETTERS = re.compile(r"\W+")
_COMMON_PARAMETERS = ("/use_sim_time", "/robot_description")
_LOGS = {1: ("/rosout", "rosgraph_msgs/Log"), 2: ("/rosout", "rcl_interfaces/msg/Log")}
_COMMAND_TYPES = VELOCITY_TYPES | NUMERIC_COMMAND_TYPES
_COST = (
    "{topic} passes through the gateway of {node}, where 1 MB costs some 2 ms of processor time: "
    "delete it from the manifest if the app can do without"
)
_OUTSIDE = (
    "is outside the cell of {node}: who forges its messages reaches the guard, which checks them "
    "by the plan alone; give it a cell of its own"
)
_WITH_MASTER = ", or start `rtron master` and keep its name"
_NO_TYPE = "its type is not known: write it into the manifest"
_PARAMETERS = "{node} has the parameters of its start: its parameter services do not pass"


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """A node that is to run in a cell: what passes, and what a person should know of it.

    `options` are those of `rtron cell`.
    """

    manifest: CellManifest
    notes: tuple[str, ...] = ()
    options: tuple[str, ...] = ()

    @property
    def script(self) -> str:
        """The name of the script that runs the node."""
        return f"cell{_NOT_LETTERS.sub('_', self.manifest.node)}"

    def texts(self) -> dict[str, str]:
        """Return the files by name: the manifest, and the script, which is a launch-prefix."""
        manifest = f"{self.script}.json"
        document = {"schema": CELL_SCHEMA, **asdict(self.manifest)}
        files = f'--plan "${{0%/*}}/{PLAN_FILE}" --manifest "${{0%/*}}/{manifest}"'
        run = shlex.join(CELL_COMMAND)
        options = "".join(f" {shlex.quote(option)}" for option in self.options)
        script = (
            "#!/bin/sh\n# A launch-prefix: the node behind it runs in a cell.\n"
            f'exec {run} {files}{options} -- "$@"\n'
        )
        return {self.script: script, manifest: json.dumps(document, indent=2) + "\n"}


@dataclass(slots=True)
class _CellPlanner:
    """Looks at one node of a graph; `notes` say what is left out."""

    graph: InteractionGraph
    plan: Plan
    node: str
    notes: list[str] = field(default_factory=list)

    def manifest(self) -> CellManifest:
        private = private_names(self.node, enforced_streams(self.plan))
        parameters = (self.node, *_COMMON_PARAMETERS) if self.graph.ros == 1 else ()
        return CellManifest(
            node=self.node,
            published=tuple(self._published(private)),
            subscribed=tuple(self._subscribed(private)),
            served=tuple(self._served()),
            called=tuple(self._called()),
            parameters=parameters,
        )

    def _published(self, private: Mapping[str, str]) -> Iterator[CarriedTopic]:
        topics = {each.topic: each.type for each in self.graph.published_by(self.node)}
        log_topic, log_type = _LOGS[self.graph.ros]
        for topic, type in sorted({log_topic: log_type, **topics}.items()):
            if topic not in private and self._may_pass(topic):
                yield CarriedTopic(topic=topic, type=type, publishers=(self.node,))

    def _subscribed(self, private: Mapping[str, str]) -> Iterator[CarriedTopic]:
        for endpoint in _each_topic(self.graph.subscribed_by(self.node)):
            topic = endpoint.topic
            publishers = {each.node for each in self.graph.publishers(topic)} - {self.node}
            if topic in private or not self._may_pass(topic):
                continue
            if self._is_command(endpoint):
                self._leave_out(topic, "can move the robot: guard it in the plan")
            elif not publishers:
                self._leave_out(topic, "nobody of the graph publishes it")
            else:
                yield CarriedTopic(
                    topic=topic, type=endpoint.type, publishers=tuple(sorted(publishers))
                )

    def _is_command(self, endpoint: Endpoint) -> bool:
        """Tell whether who publishes here moves the robot, by the type or as an action's client."""
        goals = {
            ros1_topic_name(action.name, part)
            for action in self.graph.actions
            if action.node == self.node and action.role is ActionRole.SERVER
            for part in ROS1_CLIENT_TOPICS
        }
        return normalise_type(endpoint.type) in _COMMAND_TYPES or endpoint.topic in goals

    def _served(self) -> Iterator[CarriedService]:
        for service in self.graph.services:
            if service.node != self.node or service.implicit or not self._may_pass(service.name):
                continue
            clients = {each.node for each in self.graph.clients if each.name == service.name}
            if clients and self._has_type(service):
                names = tuple(sorted(clients))
                yield CarriedService(service=service.name, type=service.type, clients=names)
            elif not clients:
                self._leave_out(service.name, "nobody of the graph calls it")

    def _called(self) -> Iterator[CarriedService]:
        for client in self.graph.clients:
            is_own = client.node == self.node and not client.implicit
            if is_own and self._may_pass(client.name) and self._has_type(client):
                clients = (self.node,)
                yield CarriedService(service=client.name, type=client.type, clients=clients)

    def note_costs(self, manifest: CellManifest) -> None:
        """Note the topics that are dear to carry."""
        for each in (*manifest.published, *manifest.subscribed):
            if is_large(each.type):
                self.notes.append(_COST.format(topic=each.topic, node=self.node))

    def note_actions(self) -> None:
        """Note the actions that no coordination node carries."""
        guarded = {stream.action for stream in build_streams(self.plan) if stream.action}
        for action in self.graph.actions:
            if action.node == self.node and action.name not in guarded:
                role = "serves" if action.role is ActionRole.SERVER else "calls"
                self._leave_out(action.name, f"{self.node} {role} this action: guard it")

    def note_publishers(self) -> None:
        """Note whose own end stays outside."""
        for stream in enforced_streams(self.plan):
            if any(matches_node(successor, self.node) for successor in stream.successors):
                for flow in stream.flows:
                    if flow.publisher not in self.plan.cell:
                        why = _OUTSIDE.format(node=self.node)
                        remedy = _WITH_MASTER if self.graph.ros == 1 else ""
                        self.notes.append(f"{flow.publisher} {why}{remedy}")

    def _has_type(self, service: Service | ServiceClient) -> bool:
        """Tell whether a service can be carried: on ROS 2 its type is needed."""
        if not service.type and self.graph.ros != 1:
            self._leave_out(service.name, _NO_TYPE)
        return bool(service.type) or self.graph.ros == 1

    def _may_pass(self, name: str) -> bool:
        if not may_pass(name) and "{" in name:
            self._leave_out(name, "the name is known only in part: write it into the manifest")
        return may_pass(name)

    def _leave_out(self, name: str, why: str) -> None:
        self.notes.append(f"{name} does not pass into or out of the cell of {self.node}: {why}")


def plan_cells(
    graph: InteractionGraph, plan: Plan, options: Sequence[str] = ()
) -> tuple[Cell, ...]:
    """Return what the cells of a plan need.

    InputError if the graph has no such node, or the files of two would have one name.
    """
    cells = tuple(_plan_cell(graph, plan, node, tuple(options)) for node in plan.cell)
    nodes: dict[str, str] = {}
    for cell in cells:
        node = cell.manifest.node
        if nodes.setdefault(cell.script, node) != node:
            raise InputError(
                f"the files of {nodes[cell.script]} and {node} have one name", help="rename a node"
            )
    return cells


def _plan_cell(graph: InteractionGraph, plan: Plan, node: str, options: tuple[str, ...]) -> Cell:
    known = sorted({each.name for each in graph.nodes})
    if node not in known:
        raise InputError(f"the app has no node {node} for a cell", help=suggestion(node, known))
    planner = _CellPlanner(graph, plan, node)
    manifest = planner.manifest()
    planner.note_costs(manifest)
    planner.note_actions()
    planner.note_publishers()
    if graph.ros != 1:
        planner.notes.append(_PARAMETERS.format(node=node))
    count = len(manifest.published) + len(manifest.subscribed)
    planner.notes.insert(0, f"{node} runs in a cell; {count} topics pass beside the plan's")
    return Cell(manifest=manifest, notes=tuple(dict.fromkeys(planner.notes)), options=options)


def _each_topic(endpoints: Sequence[Endpoint]) -> list[Endpoint]:
    return list({each.topic: each for each in endpoints}.values())
