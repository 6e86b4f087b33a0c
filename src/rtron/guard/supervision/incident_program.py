"""The recorder of incidents as a program that the bulk process starts."""

import socket

from rtron.guard.incidents.recorder import run_recorder
from rtron.guard.supervision.programs import leave_terminal, open_descriptors


def main(numbers: str) -> None:
    """Record what comes over the socket that is open."""
    leave_terminal()
    (descriptor,) = open_descriptors(numbers)
    run_recorder(socket.socket(fileno=descriptor))
