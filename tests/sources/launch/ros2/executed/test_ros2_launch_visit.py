"""What stands in a visit for the time, for processes, and for the Python to be found."""

import asyncio
import sys
from types import SimpleNamespace

import pytest

from rtron.sources.launch.ros2.executed.execution import add_lines
from rtron.sources.launch.ros2.executed.python_process import find_pythons
from rtron.sources.launch.ros2.executed.visit.clock import TimeSkippingLoop
from rtron.sources.launch.ros2.executed.visit.locations import (
    context_local,
    creation_location,
    error_location,
)
from rtron.sources.launch.ros2.executed.visit.process_stub import (
    EXIT_DELAY_S,
    UNUSED_PID,
    start_nothing,
)
from rtron.sources.launch.ros2.executed.visit.visit_record import VisitRecord
from rtron.sources.launch.ros2.result import AppLaunch, LaunchStart, StartKind
from rtron.vocabulary import Evidence


@pytest.fixture
def loop():
    loop = TimeSkippingLoop()
    yield loop
    loop.close()


def test_timers_fire_in_their_order_without_a_wait(loop):
    fired = []

    async def after(seconds):
        begun = loop.time()
        await asyncio.sleep(seconds)
        fired.append((seconds, loop.time() - begun >= seconds))

    async def all_of_them():
        await asyncio.gather(*map(after, (1e7, 3_600.0, 86_400.0)))

    loop.run_until_complete(all_of_them())
    assert fired == [(3_600.0, True), (86_400.0, True), (1e7, True)]


def test_a_thread_is_waited_for(loop):
    async def asked():
        return await loop.run_in_executor(None, lambda: "answer")

    assert loop.run_until_complete(asked()) == "answer"


@pytest.mark.parametrize("start", ["subprocess_exec", "subprocess_shell"])
def test_a_loop_starts_no_process(loop, start):
    async def run():
        await getattr(loop, start)(asyncio.SubprocessProtocol, "true")

    with pytest.raises(RuntimeError, match="nothing is started"):
        loop.run_until_complete(run())


class _Protocol:
    def __init__(self):
        self.complete = asyncio.get_running_loop().create_future()

    def connection_made(self, transport):
        self.transport = transport

    def process_exited(self):
        self.complete.set_result(self.transport.get_returncode())


def test_a_process_seems_to_run_and_to_end_well(loop):
    async def run():
        begun = loop.time()
        transport, protocol = await start_nothing(_Protocol, cmd=["a"], cwd=None)
        assert transport.get_pid() == UNUSED_PID
        assert transport.get_pipe_transport(1) is None
        code = await protocol.complete
        return code, loop.time() - begun >= EXIT_DELAY_S

    assert loop.run_until_complete(run()) == (0, True)


def test_none_starts_again(loop):
    command = ["again"]

    async def run():
        await start_nothing(_Protocol, cmd=command)
        with pytest.raises(RuntimeError, match="start again"):
            await start_nothing(_Protocol, cmd=command)
        await start_nothing(_Protocol, cmd=list(command))

    loop.run_until_complete(run())


def test_a_mark_is_of_one_command():
    found = VisitRecord()
    first, again, other = map(found.mark_command, ("a b", "a b", "c"))
    assert first == again != other
    assert found.command_of_mark(f"x {other} y") == "c"
    assert [
        found.command_of_mark(text)
        for text in ("", "x", "rtron_command_9_output", "rtron_command_x_output")
    ] == [""] * 4
    assert found.commands == ["a b", "c"]


def test_places():
    context = SimpleNamespace(locals=SimpleNamespace(current_launch_file_path="/a.launch.xml"))
    assert context_local(context, "nothing") is None
    assert creation_location(object(), context) == ("/a.launch.xml", 0)
    thing = SimpleNamespace(_rtron_place=("/b.py", 3))
    assert creation_location(thing, context) == ("/b.py", 3)
    assert error_location(ValueError("never raised")) == ("", 0)
    assert error_location(SyntaxError("s", ("/c.py", 7, 1, "("))) == ("/c.py", 7)


def test_the_python_of_ros2_comes_first(tmp_path):
    script = tmp_path / "ros2"
    for line, first in (
        ("#!/opt/bin/python3.12 -E", ["/opt/bin/python3.12"]),
        ("#!/usr/bin/env python3", []),
        ("no script", []),
        ("#!", []),
        ("#!/bin/sh", []),
    ):
        script.write_text(f"{line}\n")
        script.chmod(0o755)
        assert list(find_pythons({"PATH": str(tmp_path)})) == [*first, sys.executable]
    python = tmp_path / "python3"
    python.write_text("")
    python.chmod(0o755)
    assert list(find_pythons({"PATH": str(tmp_path)})) == [str(python), sys.executable]
    assert sys.executable in find_pythons({})


def start(line, program="e"):
    place = Evidence(file="/a.launch.xml", line=line)
    return LaunchStart(kind=StartKind.NODE, package="p", program=program, evidence=place)


def test_lines_come_from_reading_where_they_are_certain():
    read = AppLaunch(file="f", starts=(start(3), start(5, "two"), start(6, "two"), start(9, "x")))
    executed = AppLaunch(
        file="f", starts=(start(0), start(0, "two"), start(0, "no"), start(8, "x"))
    )
    found = add_lines(executed, read).starts
    assert [one.evidence.line for one in found] == [3, 0, 0, 8]
