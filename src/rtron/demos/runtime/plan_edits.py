"""The developer's decisions, written into the plan that RTron proposes.

Decisions are plain data with the words of the plan's file. What they do not mention stays as it
was proposed.

    {"app": "tb3_demo",
     "grcn": {"/cmd_vel": {"policy": "Preemption", "priorities": {"/move_base": 2}},
              "/goal": {"flows": {"/mission": {"timeout": "1 s"}}}},
     "rsrcn": {"policy": "Constrain", "max_vel_limit": "0.22 m/s", "vflows": ["/control/max_vel"]},
     "msrcn": {"aflows": ["/goal"], "areas": […], "rules": […]},
     "fps_monitor": [{"node": "/recogniser", "topic": "/detect/objects"}],
     "clients": {"/teleop/cmd_vel": ["/bridge/assistant"]},
     "leases": […], "incidents": {…}}

`clients` are nodes that no scan sees, since they come over a bridge; each gets a flow on a topic.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from rtron.errors import InputError
from rtron.planning.plan_file.loader import parse_plan
from rtron.planning.plan_file.writer import write_plan
from rtron.planning.plan_file.yaml_parser import read_text

PlanSection = dict[str, Any]
_FLOWS = {"rsrcn": "vflows", "msrcn": "aflows"}
_WHOLE = ("leases", "incidents")


class _AliasFreeDumper(yaml.SafeDumper):
    """Writes what stands in two places twice: a plan has no aliases."""

    def ignore_aliases(self, data: object) -> bool:  # noqa: ARG002 - as its base class has it
        return True


def write_decided_plan(plan: Path, out: Path, decisions: Mapping[str, Any]) -> None:
    """Write `plan` with the decisions in it to `out`.

    InputError if a decision names what the plan does not have, PlanError if no plan comes out.
    """
    decided = with_decisions(yaml.safe_load(read_text(plan)), decisions)
    text = yaml.dump(decided, Dumper=_AliasFreeDumper, sort_keys=False)
    out.write_text(write_plan(parse_plan(text, str(out))), encoding="utf-8")


def with_decisions(plan: Mapping[str, Any], decisions: Mapping[str, Any]) -> PlanSection:
    """Return a plan, as its file has it, with the decisions in it."""
    plan = _with_clients(plan, decisions.get("clients", {}))
    whole = {name: decisions[name] for name in _WHOLE if name in decisions}
    decided = {**plan, **whole, "app": decisions.get("app", plan["app"])}
    chosen = decisions.get("grcn", {})
    for topic in chosen:
        _grcn_of_topic(plan, topic)
    if chosen:
        decided["grcn"] = [_grcn(each, chosen.get(each["topic"])) for each in plan["grcn"]]
    for kind in _FLOWS.keys() & decisions.keys():
        decided[kind] = _node(plan, kind, decisions[kind])
    if "fps_monitor" in decisions:
        decided["fps_monitor"] = [_monitor(plan, each) for each in decisions["fps_monitor"]]
    return decided


def _with_clients(
    plan: Mapping[str, Any], clients: Mapping[str, Sequence[str]]
) -> Mapping[str, Any]:
    """Return a plan in which these clients publish topics of the MSRCN, which get GRCNs."""
    added, aflows = [], list(plan.get("msrcn", {}).get("aflows", ()))
    for topic, nodes in clients.items():
        index = next((n for n, each in enumerate(aflows) if each["topic"] == topic), None)
        if index is None:
            raise _unknown("action", topic)
        flows = [{"name": node.rpartition("/")[2], "publisher": node} for node in nodes]
        aflows[index] = {**aflows[index], "flows": [*aflows[index]["flows"], *flows]}
        added.append({"id": f"grcn{topic.replace('/', '_')}", **_COMMAND, **aflows[index]})
    if not added:
        return plan
    msrcn = {**plan["msrcn"], "aflows": aflows}
    return {**plan, "grcn": [*plan["grcn"], *added], "msrcn": msrcn}


_COMMAND = {"domain": "Control", "kind": "command", "sharing": "contend"}


def _grcn(proposed: PlanSection, decision: Mapping[str, Any] | None) -> PlanSection:
    """Return a GRCN; of the decision, `priorities` and `flows` are by publisher."""
    if decision is None:
        return proposed
    decision_fields = dict(decision)
    priorities, changes = decision_fields.pop("priorities", {}), decision_fields.pop("flows", {})
    unknown = {*priorities, *changes} - {flow["publisher"] for flow in proposed["flows"]}
    if unknown:
        raise _unknown(f"publisher of {proposed['topic']}", min(unknown))
    flows = [
        {**flow, **_priority(flow, priorities), **changes.get(flow["publisher"], {})}
        for flow in proposed["flows"]
    ]
    return {**proposed, "mode": "enforce", **decision_fields, "flows": flows}


def _priority(flow: PlanSection, priorities: Mapping[str, int]) -> PlanSection:
    priority = priorities.get(flow["publisher"])
    return {} if priority is None else {"priority": priority}


def _node(plan: Mapping[str, Any], kind: str, decision: Mapping[str, Any]) -> PlanSection:
    """Return the RSRCN or MSRCN; of its topics those that the decision names, in that order."""
    proposed = plan.get(kind) or {"id": kind, "policy": "Block"}
    flows, decision_fields = _FLOWS[kind], dict(decision)
    known = proposed.get(flows, [])
    topics: Sequence[str] = decision_fields.pop(flows, [each["topic"] for each in known])
    guarded = [_guarded(plan, known, topic) for topic in topics]
    return {**proposed, "mode": "enforce", **decision_fields, flows: guarded}


def _guarded(plan: Mapping[str, Any], known: Sequence[PlanSection], topic: str) -> PlanSection:
    """Return a guarded topic as it was proposed, or else as the GRCN on it has it."""
    for each in known:
        if each["topic"] == topic:
            return each
    grcn = _grcn_of_topic(plan, topic)
    flows = [{key: flow[key] for key in ("name", "publisher")} for flow in grcn["flows"]]
    return {**{key: grcn[key] for key in ("topic", "type", "successors")}, "flows": flows}


def _monitor(plan: Mapping[str, Any], decision: Mapping[str, Any]) -> PlanSection:
    """Return an fps_monitor, on what was proposed for its node and topic."""
    for each in plan.get("fps_monitor", []):
        if (each["node"], each["topic"]) == (decision["node"], decision["topic"]):
            return {**each, **decision}
    return dict(decision)


def _grcn_of_topic(plan: Mapping[str, Any], topic: str) -> PlanSection:
    for grcn in plan.get("grcn", []):
        if grcn["topic"] == topic:
            found: PlanSection = grcn
            return found
    raise _unknown("guarded topic", topic)


def _unknown(what: str, name: str) -> InputError:
    return InputError(f"the plan has no {what} {name}", help="`rtron plan` shows what it has")
