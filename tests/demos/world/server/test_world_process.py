"""`python -m rtron.demos.world`: begins, ends, and says why it cannot."""

import os
import signal
import subprocess
import sys
from contextlib import contextmanager

import pytest
from world_client import KEY, LIMIT

from rtron.demos.world.client import WorldClient
from rtron.errors import SourceError


@contextmanager
def process(path, *arguments, **environ):
    popen = subprocess.Popen(
        [sys.executable, "-m", "rtron.demos.world", str(path), *arguments],
        env=os.environ | environ,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        yield popen
    finally:
        popen.kill()
        popen.communicate()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_the_process_ends_cleanly_and_says_nothing(tmp_path, number):
    path = tmp_path / "world"
    with process(path, "--speed", "2", DEMO_KEY=KEY) as world:
        with WorldClient.connect(path, KEY, 60.0) as owner:
            assert owner.speed == 2.0
            assert owner.poll(LIMIT)
            world.send_signal(number)
            assert world.wait(LIMIT) == 0
            with pytest.raises(SourceError):
                owner.count_devices()
        assert world.communicate() == ("", "")
    assert not path.exists()


@pytest.mark.parametrize(
    ("arguments", "environ", "said"),
    [
        (["--speed", "99"], {"DEMO_KEY": KEY}, "need 0.25 to 8"),
        (["--speed", "nan"], {"DEMO_KEY": KEY}, "need 0.25 to 8"),
        ([], {"DEMO_KEY": ""}, "DEMO_KEY is not set"),
    ],
)
def test_a_world_that_cannot_be_says_why(tmp_path, arguments, environ, said):
    with process(tmp_path / "world", *arguments, **environ) as world:
        _, errors = world.communicate(timeout=60)
        assert world.returncode == 2
        assert said in errors


def test_no_world_is_an_error_after_the_limit(tmp_path):
    with pytest.raises(SourceError, match="no world at"):
        WorldClient.connect(tmp_path / "absent", KEY, 0.0)
