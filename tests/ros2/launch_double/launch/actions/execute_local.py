from pathlib import Path

from launch.core import Action, normalize, perform
from launch.event_handlers import OnProcessExit
from launch.events import ProcessExited, ProcessStarted


class ExecuteLocal(Action):
    def __init__(
        self,
        *,
        cmd,
        name=None,
        prefix=None,
        on_exit=None,
        **kwargs,
    ):
        for known in ("output", "shell", "respawn", "respawn_delay", "cwd", "env"):
            kwargs.pop(known, None)
        super().__init__(**kwargs)
        self.__cmd = [normalize(word) for word in cmd]
        self.__prefix = [] if prefix is None else prefix.split()
        self.__name, self.__on_exit = name, on_exit
        self.__details = None

    @property
    def cmd(self):
        return self.__details["cmd"] if self.__details else self.__cmd

    @property
    def process_details(self):
        return self.__details

    def get_sub_entities(self):
        return self.__on_exit if isinstance(self.__on_exit, list) else []

    def execute(self, context):
        if self.__details:
            raise RuntimeError("executed more than once")
        words = [*self.__prefix, *(perform(context, word) for word in self.__cmd)]
        name = self.__name or Path(words[0]).name
        self.__details = {"action": self, "name": name, "cmd": words}
        if self.__on_exit is not None:
            on_exit = OnProcessExit(target_action=self, on_exit=self.__on_exit)
            context.register_event_handler(on_exit)
        context.emit_event_sync(_Starting(self.__details))


class ExecuteProcess(ExecuteLocal):
    pass


class _Starting:
    """The process starts, some time after its action was executed."""

    def __init__(self, details):
        self.details = details

    def start(self, context):
        """Take the process for started, and for ended at once."""
        context.started.append(list(self.details["cmd"]))
        context.emit_event_sync(ProcessStarted(**self.details))
        context.emit_event_sync(ProcessExited(**self.details))
