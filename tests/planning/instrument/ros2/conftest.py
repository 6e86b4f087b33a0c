"""Guards a Python launch file and launches it."""

import pytest
from wrapped_launch import HEAD, REMAPS, launch

from rtron.planning.instrument.ros2.wrapper import WrappedStart, wrapper_text


@pytest.fixture
def guarded(tmp_path):
    """Return a function that guards a Python launch file with a table, and launches it."""

    def run(body, *arguments, table=REMAPS, guard="", **start):
        app = tmp_path / "app.launch.py"
        app.write_text(HEAD.format(body))
        out = tmp_path / "guarded.launch.py"
        out.write_text(wrapper_text(str(app), table, WrappedStart(guard, **start)))
        return launch(out, *arguments)

    return run
