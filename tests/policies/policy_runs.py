"""Runs of a policy: settings in tiny numbers, so that every gap lies at some bound."""

from dataclasses import dataclass, field, replace

from hypothesis import settings as effort
from hypothesis import strategies as st

from rtron.policies import build_policy
from rtron.policies.state_machine import StateMachine
from rtron.policies.state_transfer import LeaseState
from rtron.vocabulary import (
    UNAPPROVED,
    Decision,
    Flow,
    PolicyName,
    PolicySettings,
    StreamKind,
    Verdict,
)

RELEASE_AFTER, MAX_AGE, MAX_HOLD = 10, 13, 25
LOW, MIDDLE, HIGH, BLOCKED, STRANGER = "low", "middle", "high", "blocked", "stranger"
APPROVED = (LOW, MIDDLE, HIGH)
FLOWS = (
    Flow(name=LOW, publisher="/low", priority=1),
    Flow(name=MIDDLE, publisher="/middle", priority=2, timeout=7),
    Flow(name=HIGH, publisher="/high", priority=3, timeout=16),
    Flow(name=BLOCKED, publisher="/blocked", priority=9, block=True),
)
# Two and a half times the examples of the profile that is loaded.
often = effort(max_examples=effort().max_examples * 5 // 2, deadline=None)
QUEUES = (PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE)
LIMITS = (PolicyName.SAFE, PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN)
TICK, DONE = "tick", "done"


def settings(policy, kind=StreamKind.COMMAND, flows=FLOWS, **others):
    bounds = {
        "release_after": RELEASE_AFTER,
        "max_age": MAX_AGE,
        "max_hold": MAX_HOLD,
        "threshold": 0.05,
        "max_vel_limit": 0.5,
    }
    return PolicySettings(policy=policy, kind=kind, flows=flows, **{**bounds, **others})


def timeout_of(flow, chosen):
    timeout = next(f.timeout for f in chosen.flows if f.name == flow)
    return chosen.release_after if timeout is None else timeout


class RecordingMachine(StateMachine):
    """A machine that notes the effects of its steps."""

    def __init__(self, machine):
        super().__init__(machine._table, machine.state)
        self.effects = []

    def step(self, input):
        self.effects.append(super().step(input))
        return self.effects[-1]


def watch_effects(policy):
    """Return a list that gets the effect of every step of a policy's machine."""
    policy._machine = RecordingMachine(policy._machine)
    return policy._machine.effects


@dataclass(frozen=True)
class Message:
    number: int
    flow: str
    arrived: int


@dataclass
class Run:
    """Plays (gap, what) steps and notes what became of every message."""

    settings: PolicySettings
    prompt: bool = False
    now: int = 0
    messages: list[Message] = field(default_factory=list)
    verdicts: list[Verdict] = field(default_factory=list)
    left: list[tuple[int, Message, Verdict]] = field(default_factory=list)
    story: list[tuple[int, Message, Decision | None]] = field(default_factory=list)
    held: set[Message] = field(default_factory=set)
    most_held: int = 0
    went: LeaseState | None = None

    def __post_init__(self):
        self.policy = build_policy(self.settings)

    def play(self, steps):
        for gap, what in steps:
            self.wait(gap)
            self.do(what)
            if self.prompt:
                self.tick_if_due()
        return self

    def wait(self, gap):
        end = self.now + gap
        while self.prompt and (due := self.policy.deadline()) is not None and due <= end:
            self.now = max(self.now, due)
            self.tick()
        self.now = end

    def tick_if_due(self):
        due = self.policy.deadline()
        if due is not None and due <= self.now:
            self.tick()

    def do(self, what):
        if what == TICK:
            self.tick()
        elif what == DONE:
            self.went = None
            self.policy.observe_done(self.now)
        elif isinstance(what, PolicySettings):
            self.swap(what)
        else:
            self.say(what)

    def swap(self, chosen):
        """Put other settings in force, as the guard's pipeline does."""
        before, self.policy, self.settings = self.policy, build_policy(chosen), chosen
        carried = before.export_state(self.now)
        if not carried.has_lease:
            carried = replace(carried, lease=self.went)
        self.note(before.close())
        self.note(self.policy.restore_state(carried, self.now))

    def say(self, flow):
        message = Message(len(self.messages), flow, self.now)
        self.messages.append(message)
        self.story.append((self.now, message, None))
        verdict = self.policy.verdict(flow, message, self.now)
        assert verdict.flow == flow
        self.verdicts.append(verdict)
        if verdict.decision is Decision.HOLD:
            self.held.add(message)
            self.most_held = max(self.most_held, len(self.held))
        else:
            self.leaves(message, verdict)
        return verdict.decision

    def tick(self):
        releases = self.policy.tick(self.now)
        due = self.policy.deadline()
        assert due is None or due > self.now
        return self.note(releases)

    def close(self):
        return self.note(self.policy.close())

    def note(self, releases):
        for release in releases:
            self.held.remove(release.message)
            assert release.verdict.flow == release.message.flow
            self.leaves(release.message, release.verdict)
        return [(release.message.number, release.verdict.decision) for release in releases]

    def leaves(self, message, verdict):
        if verdict.decision is Decision.PASS:
            self.went = LeaseState(message.flow, self.now, self.now)
        self.left.append((self.now, message, verdict))
        self.story.append((self.now, message, verdict.decision))

    def passed(self):
        return [(at, message) for at, message, v in self.left if v.decision is Decision.PASS]


BOUNDS = (RELEASE_AFTER, MAX_AGE, MAX_HOLD, 7, 16)
gaps = st.sampled_from([0, 0, 0, 1, 1, *(b + d for b in BOUNDS for d in (-1, 0, 1))]) | st.integers(
    0, 40
)
happenings = st.sampled_from([*(3 * APPROVED), BLOCKED, STRANGER, UNAPPROVED, TICK, TICK, DONE])
# Hypothesis makes lists of five on average unless there is a least size.
steps = st.lists(st.tuples(gaps, happenings), max_size=6) | st.lists(
    st.tuples(gaps, happenings), min_size=12, max_size=40
)
kinds = st.sampled_from(StreamKind)


@st.composite
def queue_settings(draw):
    timeouts = st.none() | st.sampled_from([0, 1, 7, 16, 40])
    chosen = tuple(replace(flow, timeout=draw(timeouts)) for flow in FLOWS)
    return settings(
        draw(st.sampled_from(QUEUES)),
        draw(kinds),
        chosen,
        queue_size=draw(st.integers(1, 4)),
        max_age=draw(st.sampled_from([0, 1, MAX_AGE, 100])),
        max_hold=draw(st.sampled_from([1, MAX_HOLD, 1000])),
    )
