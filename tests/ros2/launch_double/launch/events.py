class Shutdown:
    def __init__(self, *, reason):
        self.reason = reason


class TimerEvent:
    def __init__(self, *, timer_action):
        self.timer_action = timer_action


class IncludeLaunchDescription:
    def __init__(self, launch_description):
        self.launch_description = launch_description


class ExecutionComplete:
    def __init__(self, *, action):
        self.action = action


class _RunningProcessEvent:
    def __init__(self, *, action, name, cmd):
        self.action, self.process_name, self.cmd = action, name, cmd


class ProcessStarted(_RunningProcessEvent):
    pass


class ProcessExited(_RunningProcessEvent):
    pass
