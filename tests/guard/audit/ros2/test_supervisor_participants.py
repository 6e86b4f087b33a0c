"""Which participants are taken for the supervisors': what only looks like one, is not."""

import os
from types import SimpleNamespace

import pytest
from domain_scene import publisher, subscriber
from proc_folder import ANOTHER, FIRST_NAMESPACE, ProcFolder

from rtron.guard.audit.ros2.observed_graph import ObservedGraph
from rtron.guard.audit.ros2.supervisor_participants import SupervisorParticipants
from rtron.guard.transport.ros2.participants import ParticipantLiveness
from rtron.vocabulary import GUARD_NODE, SUPERVISOR_NODE

OUT = "/rtron/cmd_vel/out"
FORK_SERVER = os.getppid()
STARTER = 8000


def participant(pid, chance=b"\x2a\x2a", number=0):
    low = (pid & 0xFFFF).to_bytes(2, "little")
    return b"\x01\x0f\x78\xfd" + low + chance + bytes([number, 0, 0, 0])


OURS, SUPERVISOR = participant(os.getpid()), participant(STARTER)
TWIN = participant(STARTER, number=1)
ELSEWHERE = participant(STARTER, chance=b"\1\1")


class Audit:
    def __init__(self, folder, namespace):
        self.machine = ProcFolder(folder, namespace=namespace)
        self.start(STARTER, 1)
        self.start(FORK_SERVER, STARTER)
        self.start(os.getpid(), FORK_SERVER)
        self._processes = self.machine.processes()
        self.lives = ParticipantLiveness(OURS, self._processes)
        self.supervisor = b""
        transport = SimpleNamespace(
            processes=self._processes, supervisor_participant=lambda: self.supervisor
        )
        self._kin = SupervisorParticipants(self.lives, transport)

    def start(self, pid, parent):
        self.machine.start(pid)
        self.machine.give_parent(pid, parent)

    def found(self, *ends):
        self.lives.update((end.participant for end in ends), 0)
        return self._kin.update(ObservedGraph(ends))


@pytest.fixture(params=[FIRST_NAMESPACE, ANOTHER], ids=["machine", "container"])
def audit(request, tmp_path):
    return Audit(tmp_path, request.param)


@pytest.fixture
def contained(tmp_path):
    return Audit(tmp_path, ANOTHER)


def speaks(who, node=SUPERVISOR_NODE):
    return publisher(OUT, node, who)


@pytest.mark.parametrize("name", ["", SUPERVISOR_NODE, GUARD_NODE])
def test_who_started_our_parent_is_kin_named_or_not(audit, name):
    assert audit.found(speaks(SUPERVISOR, name)) == {SUPERVISOR}


def test_what_our_parent_has_started_is_kin(audit):
    spare, other = participant(8001), participant(8002)
    audit.start(8001, FORK_SERVER)
    audit.start(8002, STARTER)
    assert audit.found(speaks(spare), speaks(other)) == {spare}


def test_it_stays_kin_when_it_has_died_until_the_domain_has_lost_it(audit):
    assert audit.found(speaks(SUPERVISOR)) == {SUPERVISOR}
    audit.machine.end(STARTER)
    assert audit.found(speaks(SUPERVISOR)) == {SUPERVISOR}
    assert audit.found() == frozenset()


def test_somebody_else_with_its_name_is_not_kin(audit):
    other = participant(4711)
    audit.machine.start(4711)
    assert audit.found(speaks(other), speaks(SUPERVISOR)) == {SUPERVISOR}


def test_of_two_participants_of_one_process_the_first_is_kin(audit):
    assert audit.found(speaks(SUPERVISOR)) == {SUPERVISOR}
    assert audit.found(speaks(SUPERVISOR), speaks(TWIN)) == {SUPERVISOR}


def test_of_two_that_come_at_once_neither_is_until_one_has_left(audit):
    assert audit.found(speaks(SUPERVISOR), speaks(TWIN, "")) == frozenset()
    assert audit.found(speaks(SUPERVISOR)) == {SUPERVISOR}


def test_in_a_container_somebody_with_our_supervisors_id_and_another_name_is_not_kin(contained):
    assert contained.found(speaks(ELSEWHERE, "/rogue")) == frozenset()


def test_in_a_container_who_gets_another_name_is_kin_no_more(contained):
    assert contained.found(speaks(ELSEWHERE, "")) == {ELSEWHERE}
    assert contained.found(speaks(ELSEWHERE, "/rogue")) == frozenset()
    assert contained.found(speaks(ELSEWHERE, "/rogue"), speaks(SUPERVISOR)) == {SUPERVISOR}


class TestWithoutProcessIds:
    """Where GIDs tell no process, the supervisor's own word counts."""

    PRESENT, ROGUE = participant(4712), participant(4713)

    @pytest.fixture
    def audit(self, audit):
        audit.lives.has_process_ids = False
        return audit

    def test_until_one_has_told_all_with_the_name_are_kin(self, audit):
        found = [speaks(self.PRESENT), subscriber("/rosout", "/rogue", self.ROGUE)]
        assert audit.found(*found) == {self.PRESENT}

    def test_then_the_name_is_nothing(self, audit):
        found = [speaks(self.PRESENT), speaks(self.ROGUE)]
        assert audit.found(*found) == {self.PRESENT, self.ROGUE}
        audit.supervisor = self.PRESENT
        assert audit.found(*found) == {self.PRESENT}
