import asyncio
from pathlib import Path
from types import SimpleNamespace

from launch.core import Action, normalize, perform
from launch.event_handlers import OnProcessExit
from launch.events import ProcessExited, ProcessStarted


class _Protocol(asyncio.SubprocessProtocol):
    def __init__(self):
        self.complete = asyncio.get_running_loop().create_future()

    def connection_made(self, transport):
        self.transport = transport

    def process_exited(self):
        self.complete.set_result(self.transport.get_returncode())


async def async_execute_process(protocol_class, cmd, **_):
    return await asyncio.get_running_loop().subprocess_exec(protocol_class, *cmd)


class ExecuteLocal(Action):
    def __init__(  # noqa: PLR0913 - as launch has it
        self,
        *,
        cmd,
        name=None,
        prefix=None,
        env=None,
        additional_env=None,
        on_exit=None,
        output="log",
        shell=False,
        **kwargs,
    ):
        for known in ("respawn", "respawn_delay", "cwd"):
            kwargs.pop(known, None)
        super().__init__(**kwargs)
        self.__cmd = [normalize(word) for word in cmd]
        self.__prefix = [] if prefix is None else prefix.split()
        self.__name, self.__on_exit = name, on_exit
        self.__shell = shell
        self.__env, self.__more = env, additional_env or {}
        self.__details = None

    @property
    def cmd(self):
        return self.__details["cmd"] if self.__details else self.__cmd

    @property
    def shell(self):
        return self.__shell

    @property
    def process_details(self):
        return self.__details

    @property
    def process_description(self):
        return SimpleNamespace(cmd=self.__cmd)

    def get_sub_entities(self):
        return self.__on_exit if isinstance(self.__on_exit, list) else []

    def execute(self, context):
        if self.__details:
            raise RuntimeError("executed more than once")
        words = [*self.__prefix, *(perform(context, word) for word in self.__cmd)]
        name = self.__name or Path(words[0]).name
        env = {**(self.__env or context.environment), **self.__more}
        self.__details = {"action": self, "name": name, "cmd": words, "env": env}
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

    async def run(self, context):
        """Start the process, as a LaunchService does, and wait for its end."""
        _, protocol = await async_execute_process(lambda **_: _Protocol(), **self.details)
        context.emit_event_sync(ProcessStarted(**self.details))
        await protocol.complete
        context.emit_event_sync(ProcessExited(**self.details))
