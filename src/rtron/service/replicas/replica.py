"""One `rtron serve` among several on a PostgreSQL database: what it tells and learns."""

import logging
import time
from collections.abc import AsyncIterator, Collection, Sequence
from contextlib import asynccontextmanager
from secrets import randbits
from threading import Event, Lock, Thread

from anyio import to_thread
from sqlalchemy.exc import SQLAlchemyError

from rtron.service.collector.data_collector import event_message
from rtron.service.collector.token_renewal import TokenWatch
from rtron.service.controller.risk_controller import RiskController
from rtron.service.domain.alarms import HANDOVER_MESSAGE, acknowledged_change
from rtron.service.domain.rollouts.observations import rollout_message
from rtron.service.live.hub import Hub, change_message
from rtron.service.replicas.command_relay import CommandRelay
from rtron.service.replicas.live_follower import LiveFollower
from rtron.service.replicas.live_publisher import LivePublisher
from rtron.service.replicas.notice_listener import NoticeListener
from rtron.service.replicas.shared_throttles import SharedThrottles
from rtron.service.store.database import Database
from rtron.service.store.event_pages import find_events
from rtron.service.store.incidents import INCIDENT_MESSAGE
from rtron.service.store.live_guards import release_guards
from rtron.service.store.notices import (
    AcknowledgedNotice,
    CommandNotice,
    EventsNotice,
    HandoverNotice,
    IncidentNotice,
    Notice,
    ResponseNotice,
    RolloutNotice,
    SettingsNotice,
    StopRequestNotice,
    StopSentNotice,
    TokensNotice,
    post_notice,
    post_notices,
)
from rtron.service.store.settings import find_views
from rtron.service.store.shifts import find_acknowledgements

log = logging.getLogger(__name__)

_LIVE_INTERVAL_S = 0.5
_ANSWER_TIMEOUT_S = 2.0


class StopRequests:
    """Lets the replicas with the guards send stops that cannot be stored; from any thread."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._lock = Lock()
        self._answered: dict[int, Event] = {}

    def request(self, robots: Collection[str], actor: str, reason: str) -> Collection[str]:
        """Let others send stops; return for which robots one has. SQLAlchemyError if none hears."""
        numbers = {randbits(62): robot for robot in robots}
        answered = {number: Event() for number in numbers}
        notices = [
            StopRequestNotice(request=number, robot=robot, actor=actor, reason=reason)
            for number, robot in numbers.items()
        ]
        with self._lock:
            self._answered |= answered
        try:
            with self._database.session() as session:
                post_notices(session, notices)
            deadline = time.monotonic() + _ANSWER_TIMEOUT_S
            for each in answered.values():
                each.wait(max(0.0, deadline - time.monotonic()))
            return [numbers[number] for number, each in answered.items() if each.is_set()]
        finally:
            with self._lock:
                for number in numbers:
                    del self._answered[number]

    def confirm(self, number: int) -> None:
        """Tell the one who asks that the stop is sent."""
        with self._database.session() as session:
            post_notice(session, StopSentNotice(request=number))

    def note_answer(self, number: int) -> None:
        """Take note that another replica has sent the stop of a request."""
        with self._lock:
            if answered := self._answered.get(number):
                answered.set()


class Replica:
    """Takes part while it is `running`."""

    def __init__(
        self,
        database: Database,
        hub: Hub,
        controller: RiskController,
        token_watch: TokenWatch,
        throttles: SharedThrottles,
    ) -> None:
        self._database, self._hub, self._controller = database, hub, controller
        self._token_watch, self._throttles = token_watch, throttles
        self._stop_requests = StopRequests(database)
        controller.stop_elsewhere = self._stop_requests.request
        self.command_relay = CommandRelay(database, hub, throttles.queue)
        self._listener = NoticeListener(
            database, self._read_again, self._handle_notices, self._send_guards_away
        )
        self._closing = Event()

    @property
    def is_connected(self) -> bool:
        """Whether it hears of what others do."""
        return self._listener.is_connected

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Tell and learn until the end of the block."""
        threads = [
            Thread(target=self._run_live, name="live", daemon=True),
            Thread(target=self._throttles.queue.run, name="logins", daemon=True),
        ]
        self._listener.start()
        for thread in threads:
            thread.start()
        try:
            yield
        finally:
            self._closing.set()
            self._throttles.queue.close()
            for thread in threads:
                await to_thread.run_sync(thread.join)
            await to_thread.run_sync(self._listener.close)

    def _run_live(self) -> None:
        """Share what is live, again and again; a failure is told once."""
        publisher = LivePublisher(self._database, self._hub)
        follower = LiveFollower(self._database, self._hub)
        failure = ""
        while not self._closing.wait(_LIVE_INTERVAL_S):
            before, failure = failure, _share(publisher, follower)
            if failure and not before:
                log.warning("live states are not shared: %s", failure)
        self._release()

    def _release(self) -> None:
        """Leave nothing behind; what cannot be deleted counts no more once the lock is gone."""
        robots = self._hub.connected_guards().keys()
        try:
            with self._database.session() as session:
                release_guards(session, self._database.replica, robots)
        except SQLAlchemyError as error:
            log.warning("live states are not deleted: %s", type(error).__name__)

    def _read_again(self) -> None:
        """Learn what may have been told while nobody listened."""
        self._controller.push_stored(self._hub.connected_robots())
        self._token_watch.recheck()
        self._hub.close_consoles()

    def _send_guards_away(self) -> None:
        """Let guards connect to a replica that hears of stops; this one does not."""
        for guard in self._hub.connected_guards().values():
            guard.link.leave()

    def _handle_notices(self, notices: Sequence[Notice]) -> None:
        settings = [each for each in notices if isinstance(each, SettingsNotice)]
        self._handle_settings(settings)
        for notice in notices:
            if isinstance(notice, StopRequestNotice):
                self._handle_stop_request(notice)
            elif isinstance(notice, StopSentNotice):
                self._stop_requests.note_answer(notice.request)
            elif isinstance(notice, CommandNotice):
                self.command_relay.take_command(notice)
            elif isinstance(notice, ResponseNotice):
                self.command_relay.take_response(notice.response)
            else:
                self._throttles.note(notice)
        if any(isinstance(each, TokensNotice) for each in notices):
            self._token_watch.recheck()
        if self._hub.has_consoles:
            self._tell_consoles(settings, notices)
            self._tell_shifts(notices)

    def _handle_settings(self, notices: Sequence[SettingsNotice]) -> None:
        robots = {each.robot for each in notices} & self._hub.connected_robots()
        if robots:
            self._controller.push_stored(robots)

    def _handle_stop_request(self, notice: StopRequestNotice) -> None:
        if self._controller.send_requested_stop(notice.robot, notice.actor, notice.reason):
            self._stop_requests.confirm(notice.request)

    def _tell_consoles(self, settings: Sequence[SettingsNotice], notices: Sequence[Notice]) -> None:
        """Tell the consoles here of settings and events."""
        ids = [id for each in notices if isinstance(each, EventsNotice) for id in each.ids]
        with self._database.session() as session:
            views = find_views(session, {(each.app_id, each.revision) for each in settings})
            events = find_events(session, ids)
        for each in settings:
            if view := views.get((each.app_id, each.revision)):
                message = {
                    "type": "settings",
                    "robot": each.robot,
                    "view": view.model_dump(mode="json"),
                }
                self._hub.tell_consoles(message)
        for event in events:
            self._hub.tell_consoles(event_message(event))

    def _tell_shifts(self, notices: Sequence[Notice]) -> None:
        """Tell the consoles here of acknowledged alarms, notes, incidents and roll-outs."""
        robots = {each.robot for each in notices if isinstance(each, AcknowledgedNotice)}
        if robots:
            with self._database.session() as session:
                acknowledged = find_acknowledgements(session, robots)
            for robot, left in acknowledged.items():
                self._hub.tell_consoles(change_message(robot, acknowledged_change(left)))
        if any(isinstance(each, HandoverNotice) for each in notices):
            self._hub.tell_consoles(HANDOVER_MESSAGE)
        if any(isinstance(each, IncidentNotice) for each in notices):
            self._hub.tell_consoles(INCIDENT_MESSAGE)
        for notice in notices:
            if isinstance(notice, RolloutNotice):
                self._hub.tell_consoles(rollout_message(notice.id, notice.alert))


def _share(publisher: LivePublisher, follower: LiveFollower) -> str:
    """Tell and learn what is live; return why that was not possible, or nothing."""
    try:
        publisher.publish()
        follower.follow()
    except SQLAlchemyError as error:
        return type(error).__name__
    return ""
