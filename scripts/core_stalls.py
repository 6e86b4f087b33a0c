"""Hold processor cores at random, as a machine does that has other work to do."""

import ctypes
import os
import random
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

SHORTEST_S, LONGEST_S = 0.1, 3.0
MEAN_S = 0.55
EVERY_S = 12.0
"""The mean time from one stall of a core to its next."""
ALL_CORES = 1 / 3
"""The share of the stalls that hold all cores at once."""
LEAST_SHARE = 0.95
"""What real-time processes must get of a core; it is Linux's default."""
_PRIORITY = os.sched_param(50)
_PR_SET_PDEATHSIG = 1


class Stall(NamedTuple):
    """The time (s) from the start of a run during which some cores are held."""

    start: float
    end: float
    cores: list[int]


def schedule(seed: str, cores: list[int], seconds: float) -> list[Stall]:
    """Return the stalls that begin in this time. Every sixth is over 1 s."""
    chance, now, stalls = random.Random(seed), 0.0, list[Stall]()  # noqa: S311 - no secret
    gap_s = EVERY_S * (ALL_CORES + (1 - ALL_CORES) / len(cores)) - MEAN_S
    while (now := now + chance.expovariate(1 / gap_s)) < seconds:
        held = cores if chance.random() < ALL_CORES else [chance.choice(cores)]
        end = now + SHORTEST_S * (LONGEST_S / SHORTEST_S) ** (chance.random() ** 2)
        stalls.append(Stall(now, end, held))
        now = end
    return stalls


def real_time_share() -> float:
    """Return the share of a core that the kernel leaves to real-time processes."""
    files = [Path(f"/proc/sys/kernel/sched_rt_{name}_us") for name in ("runtime", "period")]
    runtime, period = (int(file.read_text("ascii")) for file in files)
    return 1.0 if runtime < 0 else runtime / period


def refusal(share: float) -> str | None:
    """Return why this machine does not allow the stalls, or None."""
    if share < LEAST_SHARE:
        return f"the kernel limits real-time processes to {share:.0%} (sched_rt_runtime_us)"
    policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, _PRIORITY)
    except PermissionError:
        return "real-time priority needs root or CAP_SYS_NICE"
    os.sched_setscheduler(0, policy, parameters)
    return None


@contextmanager
def stalling(stalls: list[Stall]) -> Iterator[None]:
    """Hold the cores as scheduled, from now on until the block ends."""
    begin, spinners = time.monotonic(), list[int]()
    try:
        for core in sorted({core for stall in stalls for core in stall.cores}):
            spinners.append(_start_spinner([each for each in stalls if core in each.cores], begin))
            os.sched_setaffinity(spinners[-1], {core})
            os.sched_setscheduler(spinners[-1], os.SCHED_FIFO, _PRIORITY)
        yield
    finally:
        for spinner in spinners:
            os.kill(spinner, signal.SIGKILL)
            os.waitpid(spinner, 0)


def _start_spinner(stalls: list[Stall], begin: float) -> int:
    """Start the process that holds a core. The kernel ends it when this process ends."""
    parent, spinner = os.getpid(), os.fork()
    if spinner:
        return spinner
    try:
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        for stall in stalls if os.getppid() == parent else []:
            time.sleep(max(0.0, begin + stall.start - time.monotonic()))
            while time.monotonic() < begin + stall.end:
                pass
    finally:
        os._exit(0)
