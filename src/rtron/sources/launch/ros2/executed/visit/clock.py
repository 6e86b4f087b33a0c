"""An event loop that does not wait: where nothing is left but a timer, its time has come."""

import asyncio
import selectors
from typing import Any, NoReturn


class _SkippingSelector(selectors.DefaultSelector):
    """Lets the clock go on where it should wait; without a timeout it waits."""

    skipped_seconds = 0.0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        """Return what is ready; where that is nothing, the timeout is over at once."""
        if timeout is None or timeout <= 0:
            return super().select(timeout)
        ready = super().select(0)
        if not ready:
            self.skipped_seconds += timeout
        return ready


class TimeSkippingLoop(asyncio.SelectorEventLoop):
    """A loop whose timers fire in their order, each as soon as nothing else is to be done."""

    def __init__(self) -> None:
        self._skipping_selector = _SkippingSelector()
        super().__init__(self._skipping_selector)

    async def subprocess_exec(self, *_: Any, **__: Any) -> NoReturn:  # noqa: ANN401 - all the same
        """Raise RuntimeError: no process is started, whoever asks for it."""
        raise RuntimeError("nothing is started")

    subprocess_shell = subprocess_exec

    def time(self) -> float:
        """Return the time, with all that was not waited for."""
        return super().time() + self._skipping_selector.skipped_seconds
