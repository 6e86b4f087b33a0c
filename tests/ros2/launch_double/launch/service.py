import asyncio
import logging

from launch.core import LaunchContext, LaunchDescriptionEntity
from launch.events import IncludeLaunchDescription, Shutdown


def visit_all(entity, context):
    assert isinstance(entity, LaunchDescriptionEntity), entity
    inner = entity.visit(context)
    entity.get_asyncio_future()
    for one in inner or ():
        visit_all(one, context)


def process(event, context):
    if isinstance(event, IncludeLaunchDescription):
        visit_all(event.launch_description, context)
    if isinstance(event, Shutdown):
        context.is_shutdown = context.is_shutdown or event.reason
    for handler in tuple(context.handlers):
        if handler.matches(event):
            context.event = event
            context.push_locals()
            given = handler.handle(event, context)
            given = given if isinstance(given, (list, tuple)) else [given]
            for entity in given:
                if entity is not None:
                    visit_all(entity, context)
            context.pop_locals()


class LaunchService:
    """Starts what a launch starts; logs the exception that ends it."""

    def __init__(self, *, noninteractive=False):
        self.context = LaunchContext()
        self.running = set()

    def include_launch_description(self, description):
        self.context.emit_event_sync(IncludeLaunchDescription(description))

    def run(self):
        return asyncio.get_event_loop().run_until_complete(self._run())

    async def _run(self):
        try:
            while self.context.events or self.running:
                await self._next()
        except Exception:
            logging.getLogger("launch").exception("caught exception in launch")
            return 1
        return 0

    async def _next(self):
        if not self.context.events:
            _, self.running = await asyncio.wait(self.running, return_when="FIRST_COMPLETED")
            return
        event = self.context.events.popleft()
        if hasattr(event, "run"):
            self.running.add(asyncio.ensure_future(event.run(self.context)))
        else:
            process(event, self.context)
