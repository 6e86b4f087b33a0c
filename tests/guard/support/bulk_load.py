"""Pictures of megabytes through the guard of an app, and the commands beside them."""

from harness import wait_for

from bench.common import testbed
from bench.soak.app import running_app
from bench.soak.base_log import BaseLog
from rtron.vocabulary import SECOND

COMMANDS = 300
MOST_DELAY = SECOND // 2
"""Other tests run beside this one; with the pictures in the way of the commands it was 1 to 5 s."""


def commands_beside_pictures(environ, folder, ros):
    """Return what a base hears while pictures are sent, from their first on."""
    with running_app(testbed.Testbed(environ, folder), ros=ros) as app:
        wait_for(lambda: len(BaseLog.read(app.files["base"]).outputs) > 50, what="the navigation")
        before = len(BaseLog.read(app.files["base"]).outputs)
        app.film()
        wait_for(lambda: app.picture_count() > 3, what="pictures behind the guard")
        heard = len(BaseLog.read(app.files["base"]).inputs)

        def since():
            log = BaseLog.read(app.files["base"])
            return BaseLog(log.inputs[heard:], log.outputs[before:])

        wait_for(lambda: len(since().inputs) > COMMANDS, what="commands", limit_s=120)
        wait_for(lambda: len(since().outputs) > COMMANDS, what="commands behind the guard")
        return since()
