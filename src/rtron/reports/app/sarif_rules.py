"""The kinds of risk as SARIF describes rules: what each finds, why it is one, and the remedy."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rtron.reports.app.risk_list import KIND_TITLE
from rtron.vocabulary import RiskKind, Triage


@dataclass(frozen=True, slots=True, kw_only=True)
class _Help:
    """A kind's text: its name in SARIF, what it finds and why that is a risk, and the remedy."""

    name: str
    finds: str
    remedy: str
    rules: tuple[str, ...]


_HELP: Mapping[RiskKind, _Help] = {
    RiskKind.GR_ST: _Help(
        name="GeneralRiskSingleTopic",
        finds="A topic has more than one publisher and a node that acts on it. The successors"
        " hear one voice and cannot tell who spoke: whoever publishes last decides.",
        remedy="Put a GRCN between the publishers and the successors: Preemption for velocities,"
        " FIFO_Queue or Priority_Queue for goals.",
        rules=("gr_st",),
    ),
    RiskKind.GR_MT: _Help(
        name="GeneralRiskMultipleTopics",
        finds="A node subscribes two or more topics of one message type. It obeys each of them,"
        " and what it does depends on which message comes last.",
        remedy="Put a GRCN before each of the topics, so that one of them at a time has a say.",
        rules=("gr_mt",),
    ),
    RiskKind.RSR: _Help(
        name="RobotSpecificRisk",
        finds="The robot's speed and the rate at which it recognises what lies ahead are set by"
        " nodes that do not know each other: it may move faster than it sees.",
        remedy="Measure the image nodes with an fps_monitor and let the RSRCN limit the velocity:"
        " Safe or Constrain.",
        rules=("rsr_image", "rsr_max_vel"),
    ),
    RiskKind.MSR: _Help(
        name="MissionSpecificRisk",
        finds="Nodes make the robot act, others tell of events, and nothing keeps an action from"
        " being taken while an event forbids it.",
        remedy="Put the MSRCN before the actuators with rules that block actions while their"
        " events hold.",
        rules=("msr_event", "msr_action"),
    ),
}


def rule_descriptors() -> list[dict[str, Any]]:
    """Return a reportingDescriptor for each kind of risk (SARIF 2.1.0 section 3.49)."""
    return [_descriptor(kind, _HELP[kind]) for kind in RiskKind]


def finding_descriptors(triage: Triage) -> list[dict[str, Any]]:
    """Return a reportingDescriptor for each rule that found something; its page explains it."""
    ignored = (finding for finding, _ in triage.ignored)
    names = {each.rule for each in (*triage.findings, *triage.known, *ignored)}
    return [
        {
            "id": name,
            "shortDescription": {"text": _sentence(name.replace("_", " "))},
            "help": {"text": f"rtron explain {name}", "markdown": f"`rtron explain {name}`"},
            "properties": {"tags": ["security", "robotics"]},
        }
        for name in sorted(names)
    ]


def rule_index(kind: RiskKind) -> int:
    """Return where a kind stands among the descriptors."""
    return list(RiskKind).index(kind)


def _descriptor(kind: RiskKind, help: _Help) -> dict[str, Any]:
    commands = ", ".join(f"`rtron explain {rule}`" for rule in help.rules)
    text = f"{help.finds}\n\nRemedy: {help.remedy}\n\nMore: {commands.replace('`', '')}"
    markdown = f"{help.finds}\n\n**Remedy:** {help.remedy}\n\n**More:** {commands}"
    return {
        "id": kind.value,
        "name": help.name,
        "shortDescription": {"text": _sentence(KIND_TITLE[kind])},
        "fullDescription": {"text": help.finds},
        "help": {"text": text, "markdown": markdown},
        "defaultConfiguration": {"level": "warning"},
        "properties": {"tags": ["security", "robotics"], "precision": "high"},
    }


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}."
