"""A guard without memory ends instead of lingering."""

import os
import subprocess
import sys

import pytest

LIMIT = """
import resource
size = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (size + {room}, size + {room}))
"""
PROBE = """
from rtron.guard.system.process_attributes import exit_if_out_of_memory
{limit}
exit_if_out_of_memory()
"""
LOOP = """
from rtron.guard.core.event_loop import EventLoop
loop = EventLoop()
{limit}
loop.call_later(0, lambda: bytearray(1 << 28))
loop.call_later(0.01, loop.stop)
loop.run()
"""


def code_of(program, room):
    text = program.format(limit=LIMIT.format(room=room))
    return subprocess.run([sys.executable, "-c", text], capture_output=True, check=False)


@pytest.mark.parametrize("program", [PROBE, LOOP])
def test_a_process_that_gets_no_memory_ends_and_says_so(program):
    ran = code_of(program, 0)
    assert ran.returncode == os.EX_OSERR
    assert ran.stderr == b"ERROR out of memory: the process ends\n"


@pytest.mark.parametrize("program", [PROBE, LOOP])
def test_a_process_that_gets_memory_goes_on(program):
    assert code_of(program, 1 << 30).returncode == 0
