"""Findings: what a person should act on, one module a rule, and this registry of them."""

from dataclasses import replace

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory import take_inventory
from rtron.findings.motion import (
    arbiter,
    command_timeout,
    lost_command,
    network_bridge,
    open_command,
    power_command,
    settable_topic,
    several_clients,
    several_publishers,
)
from rtron.findings.rule import FindingRule, finding_page
from rtron.findings.severity import shown_at
from rtron.findings.wiring import (
    bridge_mismatch,
    bypassed_node,
    double_frame,
    duplicate_node,
    frame_loop,
    idle_remap,
    incomplete_launch,
    leaked_argument,
    missed_state,
    missing_managed_node,
    missing_plugin,
    missing_program,
    mistyped_parameter,
    mixed_odometry,
    no_server,
    qos_mismatch,
    shared_output,
    sim_time,
    stray_frame,
    topic_parameter,
    type_mismatch,
    undeclared_argument,
    unmatched_topic,
    unreached_listener,
    unread_parameter,
)
from rtron.risks import RiskLists, default_lists
from rtron.risks.graph_facts import GraphFacts
from rtron.vocabulary import Finding, InteractionGraph, Severity

__all__ = [
    "FINDING_RULES",
    "FindingRule",
    "app_facts",
    "find_findings",
    "finding_page",
    "shown_at",
    "take_inventory",
]

FINDING_RULES: tuple[FindingRule, ...] = (
    several_publishers.RULE,
    several_clients.RULE,
    network_bridge.RULE,
    command_timeout.RULE,
    lost_command.RULE,
    power_command.RULE,
    open_command.RULE,
    type_mismatch.RULE,
    qos_mismatch.RULE,
    missed_state.RULE,
    unmatched_topic.RULE,
    no_server.RULE,
    incomplete_launch.RULE,
    missing_managed_node.RULE,
    missing_plugin.RULE,
    missing_program.RULE,
    duplicate_node.RULE,
    idle_remap.RULE,
    unreached_listener.RULE,
    unread_parameter.RULE,
    mistyped_parameter.RULE,
    topic_parameter.RULE,
    leaked_argument.RULE,
    undeclared_argument.RULE,
    bridge_mismatch.RULE,
    bypassed_node.RULE,
    mixed_odometry.RULE,
    shared_output.RULE,
    double_frame.RULE,
    frame_loop.RULE,
    stray_frame.RULE,
    sim_time.RULE,
    arbiter.RULE,
    settable_topic.RULE,
)


def app_facts(graph: InteractionGraph, lists: RiskLists | None = None) -> AppFacts:
    """Return what the rules ask of a graph; the order of its endpoints changes nothing."""
    endpoints = sorted(graph.endpoints, key=lambda e: (e.topic, e.direction, e.node, e.type))
    ordered = replace(graph, endpoints=tuple(endpoints))
    return AppFacts(GraphFacts(ordered, lists or default_lists()))


def find_findings(app: AppFacts) -> tuple[Finding, ...]:
    """Return the findings of an app, the worst first; those of one rule in order of subject."""
    found = [
        finding
        for rule in FINDING_RULES
        for finding in sorted(rule.check(app), key=lambda each: each.subject)
    ]
    worst_last = list(Severity)
    return tuple(sorted(found, key=lambda each: -worst_last.index(each.severity)))
