"""What reaches a base of ROS 1 of an attack, and what of the app still does."""

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress

from bench.cell.prevention_app import PROTECTIONS, App, Protection
from bench.common.intrusion import INTRUDER, NAVIGATION, TOPIC
from bench.common.prevention import Outcome, app_share, outcome_figures
from bench.common.pubsub import PUBLISHER
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import PREVENTIONS
from bench.ros1.intruder import Intruder, RepeatingGhost
from figures.figure import Figure
from rtron.errors import RTronError
from rtron.vocabulary import SECOND
from rtron.wire.ros1.xmlrpc import ros_call

_WINDOW_S = 2.0
_BURST_S, _BURSTS = 0.04, 20
_RATE, _SLOW_RATE = 200, 25
_AGAIN_S = 2.5
"""So long after an attack the navigation is heard again, or the next one gets a new app."""
_CALL_S = 5.0
_LIMIT_PARAMETER = "/bench_driver/limit"


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give, of each protection and attack, what reached the base and what the app did meanwhile."""
    found: dict[tuple[str, str], list[Outcome]] = {}
    for number in range(1, PREVENTIONS + 1):
        for protection in PROTECTIONS:
            progress(f"{protection.name}, run {number} of {PREVENTIONS}")
            for attack, outcome in _attack_all(testbed, protection):
                found.setdefault((protection.name, attack), []).append(outcome)
    for (name, attack), outcomes in found.items():
        yield from outcome_figures(f"prevention.{name}.{attack}", outcomes)


def _attack_all(testbed: Testbed, protection: Protection) -> Iterator[tuple[str, Outcome]]:
    """Try each attack; what it has left stopped is started anew."""
    attacks = list(ATTACKS)
    while attacks:
        with App(testbed, protection) as app:
            is_driven = True
            while attacks and is_driven:
                name = attacks.pop(0)
                yield name, _outcome(app, ATTACKS[name])
                is_driven = app.drives(time.monotonic_ns(), _AGAIN_S)


def _outcome(app: App, attack: Callable[[App], tuple[int, int]]) -> Outcome:
    """Attack once; the app is watched from the first message to a window after the last."""
    began = time.monotonic_ns()
    sent, calls = attack(app)
    time.sleep(_WINDOW_S)
    seconds = (time.monotonic_ns() - began) / SECOND
    heard = app.heard(NAVIGATION, began)
    reached = calls or app.heard(INTRUDER, began)
    return Outcome(sent, reached, app_share(heard, seconds))


def _register(app: App, name: str, topic: str, rate: int, *, goodbye: bool) -> tuple[int, int]:
    """Publish as a node that registers; the refusal of a master is an answer, too."""
    with Intruder(name, topic, rate) as intruder:
        with suppress(RTronError):
            intruder.register(app.master)
        time.sleep(_WINDOW_S)
        if goodbye:
            with suppress(RTronError):
                intruder.unregister(app.master)
    return intruder.message_count, 0


def _private(app: App) -> tuple[int, int]:
    return _register(app, "/intruder", app.protection.out, _RATE, goodbye=True)


def _flow(app: App) -> tuple[int, int]:
    return _register(app, "/intruder", app.protection.flow, _RATE, goodbye=True)


def _public(app: App) -> tuple[int, int]:
    return _register(app, "/intruder", TOPIC, _RATE, goodbye=True)


def _without_goodbye(app: App) -> tuple[int, int]:
    return _register(app, "/intruder", app.protection.out, _SLOW_RATE, goodbye=False)


def _planned_name(app: App) -> tuple[int, int]:
    return _register(app, PUBLISHER, app.protection.flow, _RATE, goodbye=True)


def _ghost(app: App) -> tuple[int, int]:
    with Intruder("/ghost", app.protection.out, _RATE) as ghost:
        with suppress(RTronError):
            ghost.announce_to(app.address_of_base())
        time.sleep(_WINDOW_S)
    return ghost.message_count, 0


def _repeated_update(app: App) -> tuple[int, int]:
    with RepeatingGhost("/ghost", app.protection.out, _RATE, app.address_of_base()) as ghost:
        time.sleep(_WINDOW_S)
    return ghost.message_count, 0


def _bursts(app: App) -> tuple[int, int]:
    sent = 0
    for number in range(_BURSTS):
        with Intruder(f"/burst{number}", app.protection.out, _RATE) as burst:
            with suppress(RTronError):
                burst.register(app.master)
            time.sleep(_BURST_S)
            with suppress(RTronError):
                burst.unregister(app.master)
        sent += burst.message_count
    return sent, 0


def _parameter(app: App) -> tuple[int, int]:
    """Set it to what it never was: a master keeps what an attack before has set."""
    limit = str(time.monotonic_ns())
    with suppress(RTronError):
        ros_call(app.master, "setParam", "/intruder", _LIMIT_PARAMETER, limit, timeout=_CALL_S)
    time.sleep(_WINDOW_S)
    return 1, int(app.limits.exists() and app.limits.read_text() == limit)


def _kill(app: App) -> tuple[int, int]:
    """Do what `rosnode kill` does: ask the master where the node is, and call it."""
    with suppress(RTronError):
        uri = ros_call(app.master, "lookupNode", "/intruder", "/bench_driver", timeout=_CALL_S)
        ros_call(uri, "shutdown", "/intruder", "killed", timeout=_CALL_S)
    time.sleep(_WINDOW_S)
    return 1, int(app.ends())


ATTACKS: Mapping[str, Callable[[App], tuple[int, int]]] = {
    "private": _private,
    "no_goodbye": _without_goodbye,
    "flow": _flow,
    "public": _public,
    "bursts": _bursts,
    "ghost": _ghost,
    "repeated_update": _repeated_update,
    "parameter": _parameter,
    "kill": _kill,
    "planned_name": _planned_name,
}
"""Each does its part and returns what it sent, and how many of its calls had their effect."""
