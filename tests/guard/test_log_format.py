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


HOSTILE = "car\u202e1\x1b[2J\n2027-01-15T08:00:00.000Z INFO all is well"


def refuse():
    raise ValueError(HOSTILE)


def hostile_record():
    try:
        refuse()
    except ValueError:
        failure = sys.exc_info()
    return logging.LogRecord("x", logging.WARNING, "", 0, "%s failed", (HOSTILE,), failure)


def test_what_a_stranger_chose_is_no_line_and_turns_nothing_around():
    first, *more = log_formatter().format(hostile_record()).split("\n")
    assert r"car\u202e1\x1b[2J\n2027-01-15T08:00:00.000Z INFO all is well failed" in first
    assert all(line.startswith("  ") for line in more)
    assert all(line.isprintable() for line in (first, *more))
    assert any("all is well" in line for line in more)


FLOOD = """
import logging, sys, time
from rtron.guard.log_format import start_logging
start_logging("INFO")
logger = logging.getLogger("rtron")
for number in range(int(sys.argv[1])):  # each from another place in the code
    said = ("line %d %s", (number, "x" * 1000), None)
    logger.handle(logger.makeRecord("rtron", logging.WARNING, "a.py", number, *said))
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
