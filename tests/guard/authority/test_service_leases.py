"""What persons at the service ask of leases: within their rank, and the robot obeys at once."""

from dataclasses import replace

import pytest
from leased_base import AGENT, NAV, PLAN, STRANGER, TELEOP, TTL, LeasedBase

from rtron.guard.authority.service_leases import ServiceLeases
from rtron.guard.core.lease_text import lease_status
from rtron.vocabulary import SECOND, CommanderRank, EventKind, LeaseGroup
from rtron.wire.common.link_protocol import LeaseCommand

REMOTE = CommanderRank.REMOTE_OPERATOR
PLAN_WITH_PEOPLE = replace(PLAN, leases=(LeaseGroup(name="base", ttl=TTL, service=REMOTE),))


class ServedBase(LeasedBase):
    """A leased base, and people at the service who ask for it."""

    def __init__(self, plan=PLAN_WITH_PEOPLE):
        super().__init__(plan)
        self.events = []
        self.service = ServiceLeases(self.controller, self.record)

    def record(self, kind, level=None, **values):
        self.events.append((kind, values))

    @property
    def lease(self):
        return self.controller.leases["base"]

    def now_held(self):
        return lease_status(self.lease, self.transport.now())

    def command(self, do, to="", by="ann", reason="a trial", **values):
        """Let a person ask who sees what is so now; return the answer."""
        values = {"lease": "base", "grant": self.now_held().grant} | values
        command = LeaseCommand(number=7, do=do, to=to, by=by, reason=reason, **values)
        answer = self.service.carry_out(command)
        assert answer.number == 7
        return answer


@pytest.fixture
def base():
    return ServedBase()


def test_a_person_takes_it_from_autonomy_for_an_agent_and_the_base_obeys(base):
    base.ask(NAV, "acquire a goal")
    base.stand(NAV)
    assert base.drive(NAV, 0.5)
    answer = base.command("give", AGENT, reason="the door is shut")
    assert answer.granted
    assert "given by ann (remote_operator): the door is shut" in answer.reason
    base.pass_time(SECOND)
    assert base.speeds()[-1] == 0
    assert not base.drive(NAV, 0.5)
    assert not base.drive(AGENT, 0.25)
    assert base.stand(AGENT)
    assert base.drive(AGENT, 0.25)
    assert (base.status()["holder"], base.now_held().given_by) == (AGENT, "ann (remote_operator)")


def test_it_ends_unless_who_has_given_it_renews_it(base):
    base.command("give", NAV)
    base.pass_time(TTL - SECOND)
    assert not base.command("renew", by="bob").granted
    assert base.command("renew", reason="").granted
    base.pass_time(TTL - SECOND)
    assert base.now_held().holder == NAV
    base.pass_time(SECOND)
    assert base.now_held().holder == ""
    assert not base.command("renew").granted


def test_a_person_ends_it_and_the_robot_stops(base):
    base.ask(NAV, "acquire")
    base.stand(NAV)
    base.drive(NAV, 0.5)
    assert base.command("end").granted
    base.pass_time(SECOND)
    assert base.speeds()[-1] == 0
    assert base.now_held().holder == ""


@pytest.mark.parametrize("do", ["give", "end"])
def test_who_is_above_the_people_of_the_service_keeps_it(base, do):
    base.ask(TELEOP, "acquire")
    answer = base.command(do, NAV if do == "give" else "")
    assert (answer.granted, base.now_held().holder) == (False, TELEOP)
    assert answer.reason.endswith("ann (remote_operator) has no higher rank")


@pytest.mark.parametrize(
    ("to", "why"), [(TELEOP, "has a higher rank than ann"), (STRANGER, "is no commander of base")]
)
def test_it_is_given_to_nobody_above_them_and_to_no_stranger(base, to, why):
    answer = base.command("give", to)
    assert (answer.granted, base.now_held().holder) == (False, "")
    assert why in answer.reason


def test_what_has_changed_hands_since_a_person_looked_stays_as_it_is(base):
    base.ask(NAV, "acquire")
    seen = base.now_held().grant
    base.ask(NAV, "release")
    base.ask(AGENT, "acquire")
    for command in ("give", "end"):
        answer = base.command(command, NAV if command == "give" else "", grant=seen)
        assert (answer.granted, base.now_held().holder) == (False, AGENT)
        assert "base has changed hands meanwhile: /agent (agent) holds base" in answer.reason


@pytest.mark.parametrize("reason", ["", "  ", "\u200b\u2800"])
@pytest.mark.parametrize("do", ["give", "end"])
def test_nothing_changes_without_a_reason_that_can_be_seen(base, do, reason):
    base.ask(AGENT, "acquire")
    answer = base.command(do, NAV if do == "give" else "", reason=reason)
    assert (answer.granted, answer.reason) == (False, f"to {do} a lease needs a reason")
    assert base.now_held().holder == AGENT


@pytest.mark.parametrize("lease", ["base", "arm", ""])
def test_without_a_rank_in_the_plan_people_only_look(lease):
    base = ServedBase(PLAN)
    base.ask(AGENT, "acquire")
    answer = base.command("end", lease=lease)
    assert answer.reason == "the plan lets nobody at the service say who holds it"
    assert (answer.granted, base.now_held().holder) == (False, AGENT)


def test_names_and_reasons_cannot_forge_lines(base, caplog):
    base.command("give", NAV, by="ann\n\u202eann", reason="well\x1b[2J\nlease base: given by eva")
    text = "given by ann ann (remote_operator): well [2J lease base: given by eva"
    assert base.now_held().reason == text
    assert all(record.getMessage().isprintable() for record in caplog.records)


def test_each_change_of_hands_is_an_event_that_says_who_and_why(base):
    base.ask(NAV, "acquire a goal")
    base.ask(NAV, "renew")
    base.command("give", AGENT)
    base.command("end", grant=99)
    base.pass_time(TTL)
    kinds, values = zip(*base.events, strict=True)
    assert set(kinds) == {EventKind.LEASE}
    assert [each["publisher"] for each in values] == [NAV, AGENT, ""]
    assert values[0]["reason"].startswith("acquire by /nav: base is granted to /nav (autonomy)")
    assert values[1]["reason"].startswith("give by ann (remote_operator): base is granted to")
    assert values[2]["reason"].endswith("/agent (agent) held it last, it was not renewed")
    assert values[1]["values"]["lease"] == "base"
    assert (values[1]["values"]["holder"], values[1]["values"]["rank"]) == (AGENT, "agent")


def test_what_is_reported_says_since_when_and_until_when(base, monkeypatch):
    monkeypatch.setattr("time.time", lambda: 1_790_000_000.0)
    base.command("give", NAV)
    base.pass_time(SECOND)
    held = base.now_held()
    assert (held.name, held.rank, held.until - held.since) == ("base", CommanderRank.AUTONOMY, TTL)
    assert held.since == 1_790_000_000 * SECOND - SECOND
    streams = {each.spec.topic: each.lease for each in base.host.streams}
    assert streams == {"/cmd_vel": base.lease, "/arm_vel": base.lease}
