"""Risks and findings: what a person should act on, made from an app's graph."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256

from rtron.vocabulary.enums import (
    Domain,
    RiskKind,
    RiskRole,
    Severity,
    Sharing,
    StreamKind,
    StringEnum,
)
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


class Consequence(StringEnum):
    """What a finding leads to, the worst first."""

    MOTION = "motion"
    """The robot moves when or as it must not, or does not stop."""
    FAILURE = "failure"
    """A part of the app does not work: what it needs does not arrive."""
    ODDITY = "oddity"
    """Nothing follows by itself."""


class Certainty(StringEnum):
    """How sure a finding is, the surest first."""

    CERTAIN = "certain"
    """Everything that it says was read."""
    LIKELY = "likely"
    """It follows from what was read and from what is usual."""
    POSSIBLE = "possible"
    """Something that was not read may explain it."""


class FindingLevel(StringEnum):
    """Who wants to see a finding, as zizmor's personas: each level shows those before it, too."""

    REGULAR = "regular"
    """Whoever builds or runs the robot: it has a consequence and is at least likely."""
    PEDANTIC = "pedantic"
    """Who wants a tidy app: also what is only possible, or odd."""
    AUDITOR = "auditor"
    """Who reviews the app: also what is so by design, and the paper's risks."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One cause and what it leads to, for a person.

    `subject` is the topic, service or node that it is about, `meant` the name that is likely meant
    instead, if one is near. `summary` says what can happen,
    `cause` which nodes make it so and why RTron believes it, `remedy` what to do.
    """

    rule: str
    subject: str
    summary: str
    cause: str
    remedy: str
    consequence: Consequence
    certainty: Certainty
    severity: Severity
    level: FindingLevel
    meant: str = ""
    nodes: tuple[str, ...] = ()
    topics: tuple[str, ...] = ()
    evidence: tuple[Evidence, ...] = ()

    @property
    def id(self) -> str:
        """The rule and the subject: one finding of an app."""
        return f"{self.rule}:{self.subject}"

    @property
    def fingerprint(self) -> str:
        """What stays the same when lines move and unrelated nodes come and go, 16 hex digits."""
        identity = json.dumps([self.rule, self.subject, sorted(self.nodes), sorted(self.topics)])
        return sha256(identity.encode()).hexdigest()[:16]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ignore:
    """What somebody does not want to be told again: of a rule, on topics that match a pattern.

    `place` is where it stands. A comment ignores what was read in its line or the next one.
    """

    rule: str
    topic: str = "*"
    reason: str
    place: Evidence
    is_comment: bool = False


@dataclass(frozen=True, slots=True)
class Baseline:
    """What an earlier scan has found: the ids of findings by fingerprint, and the ids of risks."""

    findings: Mapping[str, str] = field(default_factory=dict)
    risks: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class Triage:
    """The findings and risks that are news, and what became of the others.

    `gone` are the ids of findings of an earlier scan that this one does not have any more. `folds`
    has for each finding that another one tells of, new or known, the ids of both.
    """

    findings: tuple[Finding, ...]
    risks: tuple[Risk, ...] = ()
    ignored: tuple[tuple[Finding, Ignore], ...] = ()
    known: tuple[Finding, ...] = ()
    gone: tuple[str, ...] = ()
    unused: tuple[Ignore, ...] = ()
    folds: Mapping[str, str] = field(default_factory=dict)


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
