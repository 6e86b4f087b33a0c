"""How much is measured; the environment can shorten it for a trial."""

import os


def _number(name: str, default: int) -> int:
    return int(os.environ.get(f"RTRON_BENCH_{name}") or default)


RUNS = _number("RUNS", 10)
"""Interleaved runs of each way."""
HOP_SECONDS = _number("HOP_SECONDS", 3)
"""How long a run of a hop lasts, s."""
SETTLE_SECONDS = _number("SETTLE_SECONDS", 3)
"""How long a way is left alone before a load, s: a guard starts its other processes."""
LOAD_SECONDS = _number("LOAD_SECONDS", 10)
"""How long a load lasts, s."""
MESSAGES = _number("MESSAGES", 10_000_000)
"""Messages that memory is watched over."""
MEMORY_SECONDS = _number("MEMORY_SECONDS", 600)
"""How long memory is watched at most, s."""
ENDPOINTS = _number("ENDPOINTS", 1_000_000)
"""Endpoints of the large graph."""
SILENCES = _number("SILENCES", 200)
"""How often a stream falls silent, idle and busy."""
DEATHS = _number("DEATHS", 50)
"""How often the guard dies of each cause."""
VIOLATIONS = _number("VIOLATIONS", 10_000_000)
"""Velocities that are generated."""
REPLAYED = _number("REPLAYED", 200_000)
"""Messages of a bag that is replayed."""
AUDIT_RUNS = _number("AUDIT_RUNS", 20)
"""How often each intrusion is tried."""
INTRUSIONS = _number("INTRUSIONS", 10)
"""How often an intruder is watched that commands the base."""
AUDIT_SECONDS = _number("AUDIT_SECONDS", 20)
"""How long the audit's processor time is measured, s."""
CHURN_SECONDS = _number("CHURN_SECONDS", 60)
"""How long nodes come and go, s."""
GOALS = _number("GOALS", 200)
"""Goals of a run, one after the other."""
CHANGES = _number("CHANGES", 500)
"""Changes of settings, one after the other."""
CELL_ROUNDS = _number("CELL_ROUNDS", 10)
"""How often guard and supervisor die together beside a cell, of each cause."""
PREVENTIONS = _number("PREVENTIONS", 5)
"""How often each attack is tried against each protection."""
KILLS = _number("KILLS", 50)
"""How often the service and the guard are killed each."""
INGESTED = _number("INGESTED", 1_000_000)
"""Events that guards send to the security service."""
INGEST_SECONDS = _number("INGEST_SECONDS", 600)
"""How long they may take at most, s."""
FLEETS = tuple(map(int, os.environ.get("RTRON_BENCH_FLEETS", "100 300 1000").split()))
"""How many guards are connected to one service, one fleet after the other."""
ROLLOUTS = _number("ROLLOUTS", 6)
"""How often a change that is bad for some robots goes out to the largest fleet, in each way."""
FLEET_SECONDS = _number("FLEET_SECONDS", 15)
"""How long a fleet is measured, s: alone, and once more beside people's requests."""
