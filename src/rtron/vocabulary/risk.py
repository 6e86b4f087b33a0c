"""A Risk and the report that a scan gives (paper section 4)."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.vocabulary.enums import Domain, RiskKind, RiskRole, Severity, Sharing, StreamKind
from rtron.vocabulary.evidence import Evidence

RISKS_SCHEMA = "rtron.risks/2"


@dataclass(frozen=True, slots=True, kw_only=True)
class Risk:
    """A way in which a node can harm others, found by one rule.

    `one_to_one` is true where every topic has one publisher and one subscriber, the narrow
    reading of GR-MT in paper section 4.1; it marks the risk and filters nothing.
    """

    id: str
    kind: RiskKind
    rule: str
    role_nodes: Mapping[RiskRole, tuple[str, ...]]
    topics: tuple[str, ...]
    message_type: str
    successors: tuple[str, ...]
    domain: Domain
    severity: Severity
    reason: str
    one_to_one: bool = False
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class CoordinationCount:
    """How many coordination nodes a set of risks asks for, as the paper's table counts them."""

    grcn: Mapping[Domain, int]
    fps_monitor: int
    rsrcn: int
    msrcn: int


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicClass:
    """What a topic is for: its domain, whether its publishers take turns, and what it carries."""

    domain: Domain = Domain.OTHERS
    sharing: Sharing = Sharing.CONTEND
    kind: StreamKind = StreamKind.STATE


@dataclass(frozen=True, slots=True, kw_only=True)
class RiskReport:
    """The risks of an app, their number by kind, and the rules that could not run and why.

    `topic_classes` has every topic of a risk. `viewers` are the nodes that only record or show
    what they subscribe: they are nobody's successors.
    """

    app: str
    risks: tuple[Risk, ...]
    coordination_nodes: CoordinationCount
    not_run: Mapping[str, str] = field(default_factory=dict)
    topic_classes: Mapping[str, TopicClass] = field(default_factory=dict)
    viewers: tuple[str, ...] = ()
