"""A plan on its way into the guard: fetched, checked, proved by the next guard, kept on disk."""

import asyncio
from dataclasses import replace

import pytest

from rtron.errors import InputError
from rtron.guard.link import plan_intake
from rtron.guard.link.plan_folder import PlanFolder
from rtron.guard.link.plan_intake import PlanIntake
from rtron.vocabulary import Settings
from rtron.wire.common.link_protocol import (
    MAX_PLAN_LENGTH,
    Applied,
    PlanRequest,
    plan_document_digest,
)
from rtron.workflows.plan import read_checked_plan

START = """\
schema: rtron.plan/1
app: small
grcn:
  - id: drive
    topic: /cmd_vel
    type: geometry_msgs/Twist
    mode: enforce
    policy: Preemption
    successors: [/base]
    flows:
      - {name: flow1, publisher: /teleop, priority: 2}
      - {name: flow2, publisher: /planner, priority: 1}
"""
OTHER = START.replace("priority: 2", "priority: 3")
DIGEST = plan_document_digest(OTHER)
PLAN = read_checked_plan(START)
WANTED = Settings(revision=5, plan=DIGEST)


@pytest.fixture
def folder(tmp_path):
    made = PlanFolder(folder=tmp_path / "plans", start=PLAN, read=read_checked_plan)
    made.prepare()
    return made


class Robot:
    """An intake, the service that it asks, and the guard that begins with what is put in force."""

    def __init__(self, folder, document=OTHER, guard=lambda plan: plan):
        self.said, self.tried, self.document, self.guard = [], [], document, guard
        self.intake = PlanIntake(folder, self.send, self.put_in_force, proof_s=0.0)
        self.intake.note_hello(PLAN)

    def send(self, message):
        self.said.append(message)
        if isinstance(message, PlanRequest):
            self.intake.take_document(self.document)

    def put_in_force(self, plan):
        self.tried.append(plan)
        asyncio.get_running_loop().call_soon(self.intake.note_hello, self.guard(plan))

    def answers(self):
        return [each for each in self.said if isinstance(each, Applied)]

    def take(self, settings):
        """Let the guard have settings, which it answers."""
        self.intake.want(settings)
        if answer := self.intake.answer(Applied(revision=settings.revision)):
            self.said.append(answer)

    async def settle(self, settings=WANTED):
        self.take(settings)
        await self.intake._task


def test_a_plan_is_fetched_tried_and_kept(folder):
    async def run():
        robot = Robot(folder)
        await robot.settle()
        return robot

    robot = asyncio.run(run())
    assert robot.tried == [read_checked_plan(OTHER)]
    assert robot.said == [PlanRequest(digest=DIGEST), Applied(revision=5, plan=DIGEST)]
    assert folder.file.read_text() == OTHER
    assert folder.accepted() == (DIGEST, read_checked_plan(OTHER))


def test_what_the_guard_answers_waits_for_the_plan(folder):
    async def run():
        robot = Robot(folder)
        robot.intake.want(WANTED)
        early = robot.intake.answer(Applied(revision=5))
        await robot.intake._task
        assert robot.answers() == [Applied(revision=5, plan=DIGEST)]
        return early, robot.intake.answer(Applied(revision=5))

    assert asyncio.run(run()) == (None, Applied(revision=5, plan=DIGEST))


def test_settings_without_another_plan_are_answered_at_once(folder):
    async def run():
        robot = Robot(folder)
        robot.intake.want(Settings(revision=1))
        return robot.intake.answer(Applied(revision=1)), robot.said

    assert asyncio.run(run()) == (Applied(revision=1), [])


def refused(folder, **keys):
    async def run():
        robot = Robot(folder, **keys)
        await robot.settle()
        again = robot.intake.answer(Applied(revision=5))
        return robot, again

    robot, again = asyncio.run(run())
    (answer,) = robot.answers()
    assert (answer.revision, answer.plan) == (5, "")
    assert again == answer
    return robot, answer.error


def test_a_guard_that_does_not_run_with_it_brings_the_former_one_back(folder):
    _, error = refused(folder, guard=lambda _plan: PLAN)
    assert "does not run with the plan" in error
    assert not folder.file.exists()


@pytest.mark.parametrize(
    ("document", "reason"),
    [(START, "another plan than its settings name"), ("", "another plan than its settings name")],
)
def test_another_document_than_the_one_that_is_named_is_refused(folder, document, reason):
    robot, error = refused(folder, document=document)
    assert reason in error
    assert robot.tried == []


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (OTHER.replace("/base]", "/base2]"), "needs a new launch: rtron instrument: grcn drive"),
        (OTHER.replace("priority: 1", "priority: 3"), "priority"),
        (OTHER + "x: 1\n", "x"),
        ("!!python/object:os.system {}\n", "tag"),
        (OTHER + "#" * MAX_PLAN_LENGTH, "longer than"),
    ],
)
def test_a_plan_that_may_not_come_is_refused_and_nothing_is_tried(folder, text, reason):
    async def run():
        robot = Robot(folder, document=text)
        await robot.settle(Settings(revision=5, plan=plan_document_digest(text)))
        return robot

    robot = asyncio.run(run())
    (answer,) = robot.answers()
    assert reason in answer.error
    assert (robot.tried, folder.file.exists()) == ([], False)


def test_a_guard_without_a_folder_takes_no_plans():
    robot, error = refused(None)
    assert "--plans" in error
    assert robot.tried == []


def test_a_plan_that_was_refused_is_not_tried_again(folder):
    async def run():
        robot = Robot(folder, guard=lambda _plan: PLAN)
        await robot.settle()
        await robot.settle(replace(WANTED, revision=6))
        return robot

    robot = asyncio.run(run())
    assert len(robot.tried) == 1
    assert [(each.revision, bool(each.error)) for each in robot.answers()] == [(5, True), (6, True)]


def test_the_plan_of_the_start_comes_back(folder):
    async def run():
        robot = Robot(folder)
        await robot.settle()
        await robot.settle(Settings(revision=6))
        return robot

    robot = asyncio.run(run())
    assert robot.tried[-1] == PLAN
    assert robot.answers()[-1] == Applied(revision=6)
    assert not folder.file.exists()


def test_the_newest_of_several_plans_counts(folder):
    async def run():
        robot = Robot(folder)

        def overtaken(plan):
            robot.take(Settings(revision=6))
            return plan

        robot.guard = overtaken
        await robot.settle()
        return robot

    robot = asyncio.run(run())
    assert robot.answers() == [Applied(revision=6)]
    assert (robot.intake.digest, robot.tried[-1]) == ("", PLAN)


def test_a_stop_during_the_trial_is_answered_with_the_plan(folder):
    async def run():
        robot = Robot(folder)

        def stopped(plan):
            robot.take(replace(WANTED, revision=6))
            return plan

        robot.guard = stopped
        await robot.settle()
        return robot

    assert asyncio.run(run()).answers() == [Applied(revision=6, plan=DIGEST)]


def test_settings_that_go_back_while_a_plan_fails_are_answered(folder):
    async def run():
        robot = Robot(folder)

        def overtaken(_plan):
            robot.take(Settings(revision=6))
            return PLAN

        robot.guard = overtaken
        await robot.settle()
        return robot

    robot = asyncio.run(run())
    assert robot.answers() == [Applied(revision=6)]
    assert len(robot.tried) == 1


def test_each_answer_is_that_of_its_plan(folder):
    third = START.replace("priority: 2", "priority: 4")
    texts = {plan_document_digest(text): text for text in (OTHER, third)}
    last = Settings(revision=6, plan=plan_document_digest(third))

    async def run():
        robot = Robot(folder)

        def overtaken(plan):
            if len(robot.tried) == 1:
                robot.take(last)
                robot.document = texts[last.plan]
            return plan

        robot.guard = overtaken
        await robot.settle()
        return robot

    robot = asyncio.run(run())
    assert robot.answers() == [Applied(revision=6, plan=last.plan)]
    assert robot.intake.digest == last.plan


def test_a_service_that_sends_no_plan_may_send_it_later(folder, monkeypatch):
    monkeypatch.setattr(plan_intake, "FETCH_S", 0.01)

    async def run():
        robot = Robot(folder)
        robot.send, send = robot.said.append, robot.send
        robot.intake._send = robot.send
        await robot.settle()
        robot.intake._send = send
        await robot.settle(replace(WANTED, revision=6))
        return robot

    first, second = asyncio.run(run()).answers()
    assert "has not sent" in first.error
    assert second == Applied(revision=6, plan=DIGEST)


def test_settings_that_the_guard_refuses_bring_no_later_plan(folder):
    async def run():
        robot = Robot(folder)
        robot.intake.want(WANTED)
        return robot.intake.answer(Applied(revision=5, error="no such flow"))

    assert asyncio.run(run()) == Applied(revision=5, error="no such flow")


def test_a_folder_that_cannot_be_written_refuses(folder, monkeypatch):
    folder.folder.rmdir()
    _, error = refused(folder)
    assert "plan.yaml" in error


def test_an_accepted_plan_that_does_not_fit_the_start_any_more_is_not_in_force(folder, caplog):
    folder.keep(OTHER)
    moved = replace(folder, start=read_checked_plan(START.replace("/base]", "/base2]")))
    assert moved.accepted() == ("", moved.start)
    assert "the plan of the start is" in caplog.text
    assert folder.accepted()[0] == DIGEST


@pytest.mark.parametrize("data", [b"\xff", b"nonsense", b"", b"#" * (MAX_PLAN_LENGTH + 1)])
def test_a_file_that_is_no_plan_is_not_in_force(folder, data):
    folder.file.write_bytes(data)
    assert folder.accepted() == ("", PLAN)


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    made = PlanFolder(folder=tmp_path / "file" / "plans", start=PLAN, read=read_checked_plan)
    with pytest.raises(InputError):
        made.prepare()
