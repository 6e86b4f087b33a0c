"""Any node can switch the robot off or restart it.

## What it finds

Topics and services that shut the robot down, restart it or cut its power (`shutdown`, `reboot`,
`power_off`, `reset_motors`), and that no node of the app uses itself. Any node or client of a
bridge can end a mission by them.

For example, `/leo_system` obeys `/system/shutdown` and `/system/reboot`, and rosbridge forwards
both.

## What to do

Take them out of what the bridge forwards (`topics_glob`, `services_glob`), guard the topics, or
leave power to a program outside of ROS.

## When it is silent

Where a node of the app uses them. Without a bridge it is `pedantic`.
"""

import re
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.node_kinds import bridges
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel
from rtron.wording import conjugate, join_names

_OFF = re.compile(r"(?:\w+_)?(?:shutdown|shut_down|poweroff|power_off)(?:_\w+)?")
_PART = "mcu|board|system|robot|base|hardware|firmware|motors?|drivers?"
_RESTART = re.compile(
    rf"(?:\w+_)?reboot(?:_\w+)?|(?:{_PART})_(?:reset|restart)|(?:reset|restart)_(?:{_PART})"
)


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield one finding with all that switches the robot off and that the app does not use."""
    used = {client.name for client in app.graph.clients}
    services = {
        service.name: service.node
        for service in app.graph.services
        if _is_power(service.name) and not service.implicit and service.name not in used
    }
    topics = {
        topic: app.readers(topic)[0]
        for topic in app.explicit_topics
        if _is_power(topic) and app.readers(topic) and not app.publishers(topic)
    }
    owners = {**services, **topics}
    if owners:
        yield _finding(app, owners, topics)


def _is_power(name: str) -> bool:
    return any(pattern.fullmatch(name.rpartition("/")[2]) for pattern in (_OFF, _RESTART))


def _effect(names: list[str]) -> str:
    is_off = any(_OFF.fullmatch(name.rpartition("/")[2]) for name in names)
    return "switch the robot off" if is_off else "restart the robot or a part of it"


def _finding(app: AppFacts, owners: dict[str, str], topics: dict[str, str]) -> Finding:
    names, nodes = sorted(owners), sorted(set(owners.values()))
    open_to = bridges(app)
    who = f"whoever reaches {join_names(open_to)}" if open_to else "any node on the network"
    return make_finding(
        RULE.name,
        names[0],
        summary=f"{who} can {_effect(names)}",
        cause=f"{join_names(nodes)} {conjugate(nodes, 'obey')} {join_names(names)}, "
        "which no node of this launch uses",
        remedy="keep them from the bridge, or guard them: leave power to a program outside of ROS",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        level=FindingLevel.REGULAR if open_to else FindingLevel.PEDANTIC,
        nodes=nodes,
        topics=names,
        evidence=app.evidence(end for topic in topics for end in app.graph.subscribers(topic)),
    )


RULE = FindingRule(
    name="power_command",
    title="Any node can switch the robot off or restart it",
    consequence="failure: likely",
    since="0.1.0",
    check=check,
)
