"""A guarded action on real ROS 2: server, clients and guard, each a participant of its own."""

import threading
from contextlib import suppress

import rclpy
from action_msgs.msg import GoalStatus
from harness import LIMIT_S, wait_for
from plans import grcn, plan_of
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.context import Context
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from test_msgs.action import Fibonacci

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.observations import observations_of
from rtron.guard.transport.ros2.middleware import Ros2Transport
from rtron.vocabulary import (
    SECOND,
    PolicyName,
    Ros2ActionEntity,
    StreamKind,
    build_streams,
    flow_topic,
    output_topic,
    ros2_entity_name,
)
from rtron.wire.ros2.session import Ros2Session

ACTION, SERVER, ONE, TWO = "/fib", "/server", "/one", "/two"
TYPE = "test_msgs/action/Fibonacci"
REJECTED = "rejected"
STATES = {4: "succeeded", 5: "canceled", 6: "aborted"}


class _GoneError(BaseException):
    """Ends a goal of a server that has left, past rclpy, which would answer it."""


class Participant:
    """A context with one node, spun in a thread of its own."""

    def __init__(self, name, domain, *, threads=1):
        self.context = Context()
        self.context.init(args=[], domain_id=domain)
        self.node = rclpy.create_node(name.strip("/"), context=self.context)
        kind = SingleThreadedExecutor if threads == 1 else MultiThreadedExecutor
        more = {} if threads == 1 else {"num_threads": threads}
        self.executor = kind(context=self.context, **more)
        self.executor.add_node(self.node)
        self._thread = threading.Thread(target=self._spin, daemon=True)

    def start(self):
        self._thread.start()

    def nodes(self):
        return [self.node]

    def close(self):
        self.executor.shutdown(timeout_sec=5)
        self._thread.join()
        self.end.destroy()
        self.node.destroy_node()
        self.context.try_shutdown()
        self.context.destroy()

    def _spin(self):
        with suppress(rclpy.executors.ExternalShutdownException):
            self.executor.spin()


class ForgedServer(Participant):
    """Tells no status and takes no goals; says of every goal that it has succeeded."""

    def __init__(self, domain, name):
        super().__init__(name, domain)
        service = ros2_entity_name(output_topic(ACTION), Ros2ActionEntity.GET_RESULT)
        self.end = self.node.create_service(Fibonacci.Impl.GetResultService, service, self._answer)
        self.start()

    def _answer(self, _request, response):
        response.status = GoalStatus.STATUS_SUCCEEDED
        return response


class Server(Participant):
    """Serves Fibonacci: goal n ends when it is told to, goal 0 at once; it notes what it does.

    An order below 0 is rejected; one above 1000 is not cancelled when that is asked for.
    """

    def __init__(self, domain, name=SERVER, action=None, *, threads=4):
        super().__init__(name, domain, threads=threads)
        self.started, self.ended, self.cancels = [], [], []
        self.before_canceled_result = lambda: None
        self._finish = {}
        self._closing = False
        self.end = ActionServer(
            self.node,
            Fibonacci,
            action or output_topic(ACTION),
            self._execute,
            goal_callback=self._admit,
            cancel_callback=self._cancel,
            callback_group=ReentrantCallbackGroup(),
        )
        self.start()

    def finish(self, order):
        self._finish.setdefault(order, threading.Event()).set()

    def close(self):
        """Leave in the middle of what is going on."""
        self._closing = True
        super().close()

    def _admit(self, goal):
        return GoalResponse.REJECT if goal.order < 0 else GoalResponse.ACCEPT

    def _cancel(self, goal):
        self.cancels.append(goal.request.order)
        return CancelResponse.REJECT if goal.request.order > 1000 else CancelResponse.ACCEPT

    def _execute(self, goal):
        order = goal.request.order
        self.started.append(order)
        goal.publish_feedback(Fibonacci.Feedback(sequence=[order]))
        while order and not self._finish.setdefault(order, threading.Event()).wait(0.01):
            if self._closing:
                raise _GoneError
            if goal.is_cancel_requested:
                goal.canceled()
                self.ended.append(order)
                self.before_canceled_result()
                return Fibonacci.Result(sequence=[-order])
        goal.succeed()
        self.ended.append(order)
        return Fibonacci.Result(sequence=[order, order + 1])


class Client(Participant):
    """Sends goals and notes each answer: `answers` has a list of (state, sequence) by the order."""

    def __init__(self, domain, name, action):
        super().__init__(name, domain)
        self.answers, self.handles, self.feedback, self.open = {}, {}, [], set()
        self.end = ActionClient(self.node, Fibonacci, action)
        self.start()

    def ready(self):
        return self.end.server_is_ready()

    def send_goal(self, *orders):
        for order in orders:
            self.answers.setdefault(order, [])
            self.open.add(order)
            goal = Fibonacci.Goal(order=order)
            future = self.end.send_goal_async(goal, feedback_callback=self._feedback)
            future.add_done_callback(lambda done, order=order: self._admitted(order, done.result()))

    def cancel(self, order):
        wait_for(lambda: order in self.handles, what="the goal's acceptance")
        return self.handles[order].cancel_goal_async()

    def cancel_raw(self, **info):
        """Send a cancel as no client library would; return the future of its answer."""
        request = Fibonacci.Impl.CancelGoalService.Request(**info)
        return self._raw(request)

    def _raw(self, request):
        future = rclpy.task.Future(executor=self.executor)
        number = self.end._client_handle.send_cancel_request(request)
        self.end._pending_cancel_requests[number] = future
        return future

    def _feedback(self, message):
        self.feedback.append(list(message.feedback.sequence))

    def _admitted(self, order, handle):
        self.open.discard(order)
        if not handle.accepted:
            self.answers[order].append((REJECTED, []))
            return
        self.handles[order] = handle
        handle.get_result_async().add_done_callback(
            lambda done: self.answers[order].append(
                (STATES.get(done.result().status), list(done.result().result.sequence))
            )
        )


class GuardThread:
    """The guard of the action, its loop in a thread."""

    def __init__(self, domain, plan, handover=None):
        self.loop = EventLoop()
        self.session = Ros2Session(domain)
        self.transport = Ros2Transport(self.loop, self.session)
        self.coordinator = Coordinator(
            self.transport, build_streams(plan), observations_of(plan), handover=handover
        )
        self.action = self.coordinator.streams[0]
        self.loop.post(self.coordinator.open)
        self._thread = threading.Thread(target=self.loop.run, daemon=True)
        self._thread.start()

    def call(self, function):
        """Call something in the loop's thread and return what it returns."""
        done, results = threading.Event(), []

        def call():
            results.append(function())
            done.set()

        self.loop.post(call)
        assert done.wait(LIMIT_S)
        return results[0]

    def wait(self, duration):
        """Wait until the loop has called what was due within a duration from now, ns."""
        done = threading.Event()
        self.call(lambda: self.loop.call_at(self.loop.now() + duration, done.set))
        wait_for(done.is_set, what="a timer of the guard")

    def knows_status(self, status):
        """Tell whether the server has told that a goal has a status."""
        told = self.action.server._replies.status
        return self.call(lambda: status in {s.status for s in told.server_statuses.values()})

    def nodes(self):
        """Return the nodes of the guard, which are there once it has opened its streams."""
        return self.call(lambda: list(self.session._nodes.values()))

    def held(self, flow):
        """Return how many messages of a flow the guard has made wait."""
        return self.call(lambda: self.action.pipeline.tallies[flow].held)

    def close(self):
        self.loop.post(self.loop.stop)
        self._thread.join()
        self.transport.close()
        self.session.context.destroy()
        self.loop.close()


class RclpyActionApp:
    """Two approved clients, a server, and the guard between them."""

    def __init__(self, domain, policy=PolicyName.FIFO_QUEUE, *, more=None, **settings):
        self.domain = domain
        topic = grcn(
            ACTION,
            [ONE, TWO],
            [SERVER],
            type=TYPE,
            kind=StreamKind.ACTION,
            policy=policy,
            max_age=60 * SECOND,
            **settings,
        )
        self.plan = plan_of(topic, ros=2, **(more or {}))
        self.handovers = []
        self._parts = []
        try:
            self._start()
        except BaseException:
            self.close()
            raise

    def _start(self):
        self.server = self.keep(Server(self.domain))
        self.guard = self.keep(
            GuardThread(self.domain, self.plan, HandoverState(write=self.handovers.append))
        )
        wait_for(lambda: self.guard.action.server.is_available, what="the server at the guard")
        self.one = self.client(ONE, "flow1")
        self.two = self.client(TWO, "flow2")

    def keep(self, part):
        """Take a part, and wait until all parts know each other, before the next one comes."""
        self._parts.append(part)
        wait_for(self._is_settled, what="all participants to know each other")
        return part

    def _is_settled(self):
        nodes = [part.nodes() for part in self._parts]
        names = {node.get_name() for group in nodes for node in group}
        return all(names <= set(first.get_node_names()) for first, *_ in nodes)

    def client(self, name, flow="", action=ACTION):
        client = self.keep(Client(self.domain, name, flow_topic(action, flow) if flow else action))
        wait_for(client.ready, what=f"the action at {name}")
        return client

    def end(self, part):
        self._parts.remove(part)
        part.close()

    def close(self):
        for part in reversed(self._parts):
            part.close()
