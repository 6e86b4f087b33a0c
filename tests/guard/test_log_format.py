"""A log line has a time that means the same on every robot."""

import logging
import re
import subprocess
import sys

import pytest

from rtron.guard.log_format import log_formatter

LINE = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z (\w+) (.*)")
SAID = """
import logging
from rtron.guard.log_format import start_logging
start_logging("INFO", {process!r})
logging.getLogger("rtron").debug("unsaid")
logging.getLogger("rtron").warning("it %s", "stands")
"""


def test_the_time_is_utc_and_has_milliseconds(monkeypatch):
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    record = logging.LogRecord("x", logging.WARNING, "", 0, "the guard %s", ("begins",), None)
    record.created, record.msecs = 1_000_000_000.0, 7.0
    assert log_formatter("link").format(record) == (
        "2001-09-09T01:46:40.007Z WARNING link: the guard begins"
    )
    assert log_formatter().format(record).endswith("Z WARNING the guard begins")


FLOOD = """
import logging, sys, time
from rtron.guard.log_format import start_logging
start_logging("INFO")
for number in range(int(sys.argv[1])):
    logging.getLogger("rtron").warning("line %d %s", number, "x" * 1000)
print("done", flush=True)
sys.stdin.read()
"""
FLOOD_LINES = 3000


def test_who_logs_does_not_wait_for_a_reader_and_lost_lines_are_told():
    command = [sys.executable, "-c", FLOOD, str(FLOOD_LINES)]
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    with subprocess.Popen(command, **pipes, text=True) as process:
        assert process.stdout.readline() == "done\n"
        _, written = process.communicate("")
    lines = [LINE.fullmatch(each)[2] for each in written.splitlines()]
    lost = [int(each.split()[0]) for each in lines if "are lost" in each]
    assert lost
    assert sum(lost) + len(lines) - len(lost) == FLOOD_LINES


def test_a_process_ends_although_nobody_reads_its_log():
    command = [sys.executable, "-c", FLOOD, str(FLOOD_LINES)]
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    with subprocess.Popen(command, **pipes, text=True) as process:
        assert process.stdout.readline() == "done\n"
        process.stdin.close()
        assert process.wait(30) == 0


@pytest.mark.parametrize(("process", "text"), [("", "it stands"), ("link", "link: it stands")])
def test_a_process_logs_to_standard_error_with_times(process, text):
    command = [sys.executable, "-c", SAID.format(process=process)]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    (line,) = ran.stderr.splitlines()
    assert LINE.fullmatch(line).groups() == ("WARNING", text)
