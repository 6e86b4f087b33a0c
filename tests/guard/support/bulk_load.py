"""Pictures of megabytes through the guard of an app, and the commands beside them."""

from contextlib import closing

from harness import wait_for

from bench.common import testbed
from bench.soak.app import running_app
from bench.soak.base_log import BaseLog
from bench.soak.processor_wait import ProcessorWait
from rtron.vocabulary import SECOND

COMMANDS = 300
MOST_DELAY = SECOND // 2
"""With the pictures in the way of the commands it was 1 to 5 s."""


def commands_beside_pictures(environ, folder, ros):
    """Return what a base hears while pictures are sent, and the longest gap of the guard's, ns.

    A gap counts where the navigation was heard meanwhile, without the time in which other tests had
    the processors that guard and supervisor waited for.
    """
    with running_app(testbed.Testbed(environ, folder), ros=ros) as app:
        wait_for(lambda: len(BaseLog.read(app.files["base"]).outputs) > 50, what="the navigation")
        before = len(BaseLog.read(app.files["base"]).outputs)
        with closing(ProcessorWait(app)) as wait:
            app.film()
            heard = _commands_from_now(app, before)
        gaps = heard.unexplained_gaps()
        return heard, max((gap.length - wait.within(gap) for gap in gaps), default=0)


def _commands_from_now(app, before):
    wait_for(lambda: app.picture_count() > 3, what="pictures behind the guard")
    known = len(BaseLog.read(app.files["base"]).inputs)

    def since():
        log = BaseLog.read(app.files["base"])
        return BaseLog(log.inputs[known:], log.outputs[before:], log.stalls)

    wait_for(lambda: len(since().inputs) > COMMANDS, what="commands", limit_s=120)
    wait_for(lambda: len(since().outputs) > COMMANDS, what="commands behind the guard")
    return since()
