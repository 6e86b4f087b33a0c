"""The link process as a program that a supervisor starts."""

import pickle
import sys
from dataclasses import replace

from rtron.guard.link.relay import run_relay
from rtron.guard.log_format import start_logging
from rtron.guard.supervision.guard_config import read_config
from rtron.guard.supervision.plan_trial import PlanSlot
from rtron.guard.supervision.programs import leave_terminal, open_descriptors, run_program
from rtron.guard.system.sealed_memory import SharedBeat
from rtron.vocabulary import Plan


def main(numbers: str) -> None:
    """Relay as the configuration in an open file says; end with the exit code."""
    leave_terminal()
    config_file, beat, *slot = open_descriptors(numbers)
    config = read_config(config_file)
    start_logging(config.log_level, "link")

    def put_in_force(plan: Plan) -> None:
        PlanSlot(slot[0]).write(pickle.dumps(replace(config, plan=plan)))

    def relay() -> int:
        run_relay(config.options["link"], put_in_force, SharedBeat(beat))
        return 0

    sys.exit(run_program(relay))
