"""The Plan (`rtron.yaml`): coordination nodes, their flows and policies (paper section 5).

All durations are integer nanoseconds; the file gives seconds or a number with a unit.
"""

from dataclasses import dataclass

from rtron.vocabulary.enums import (
    Domain,
    Mode,
    PolicyName,
    Sharing,
    StreamKind,
)

PLAN_SCHEMA = "rtron.plan/1"
SECOND = 1_000_000_000
UNAPPROVED = "unapproved"


@dataclass(frozen=True, slots=True, kw_only=True)
class Flow:
    """One publisher's way through a coordination node.

    `publisher` is a node name, or a pattern with `*` for anonymous names. A higher `priority`
    goes first. `timeout` (ns) is how long others wait for this flow (Priority_Queue) or how long
    its action may take (FIFO_Queue).
    """

    name: str
    publisher: str
    priority: int = 0
    block: bool = False
    timeout: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class WatchedFlow:
    """A flow that is only read: `iflow` (an image node's rate) or `eflow` (an event)."""

    name: str
    topic: str
    publisher: str


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardedTopic:
    """A topic whose flows (`vflow`, `aflow`) the RSRCN or MSRCN lets pass or blocks."""

    topic: str
    type: str
    flows: tuple[Flow, ...]
    successors: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class GRCN:
    """A general risk coordination node: the publishers of one topic, before its successors.

    `release_after` (ns): silence after which a flow gives up the output (Preemption).
    `max_age` (ns): a queued message older than this is dropped. `max_hold` (ns): the longest that
    one action may hold the output. `done`: a topic whose message ends the action in progress.
    `queue_size`: messages kept for a waiting flow or a slow subscriber.
    """

    id: str
    topic: str
    type: str
    domain: Domain
    kind: StreamKind
    sharing: Sharing
    mode: Mode
    policy: PolicyName
    flows: tuple[Flow, ...]
    successors: tuple[str, ...] = ()
    release_after: int = SECOND // 2
    max_age: int = SECOND // 2
    max_hold: int = 600 * SECOND
    queue_size: int = 100
    done: str | None = None
    block_unapproved: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class FpsMonitor:
    """Measures the frame rate of one image node on the topic it publishes per frame."""

    id: str
    node: str
    topic: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RSRCN:
    """The robot-specific risk coordination node: one an app, before the users of max velocity."""

    id: str
    mode: Mode
    policy: PolicyName
    vflows: tuple[GuardedTopic, ...] = ()
    iflows: tuple[WatchedFlow, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class MSRCN:
    """The mission-specific risk coordination node: one an app, before the actuator drivers."""

    id: str
    mode: Mode
    policy: PolicyName
    aflows: tuple[GuardedTopic, ...] = ()
    eflows: tuple[WatchedFlow, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What stands between whom in the guarded app, and under which policies.

    `accept_unenforceable` names what cannot be reached and was accepted by the developer, as the
    plan's reader reported it. `revision` counts the settings.
    """

    app: str
    ros: int = 1
    revision: int = 0
    grcn: tuple[GRCN, ...] = ()
    rsrcn: RSRCN | None = None
    msrcn: MSRCN | None = None
    fps_monitor: tuple[FpsMonitor, ...] = ()
    accept_unenforceable: tuple[str, ...] = ()
