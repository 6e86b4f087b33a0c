"""Permissions, governance and policies: exact, escaped, and read back with suspicion."""

from datetime import datetime, timedelta, timezone
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st
from keystores import access_of

from rtron.errors import InputError
from rtron.security.access.rights import AccessRight, RightKind
from rtron.security.sros2.dds_topics import DdsRights, dds_rights
from rtron.security.sros2.documents import (
    Permissions,
    Protection,
    governance_xml,
    parse_permissions,
    permissions_xml,
)
from rtron.security.sros2.writer import policy_xml

NOW = datetime(2026, 3, 1, 12, 30, tzinfo=timezone.utc)
TEXT = st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Cs", "Z")), min_size=1)
NAMES = st.frozensets(TEXT, max_size=4)


def permissions_of(publish=(), subscribe=(), enclave="/nav"):
    return Permissions(
        enclave=enclave,
        domains=frozenset({3}),
        rights=DdsRights(publish=frozenset(publish), subscribe=frozenset(subscribe)),
        not_before=NOW,
        not_after=NOW + timedelta(days=1),
    )


@pytest.mark.parametrize(
    ("kind", "publish", "subscribe"),
    [
        (RightKind.PUBLISH, {"rt/x"}, set()),
        (RightKind.SUBSCRIBE, set(), {"rt/x"}),
        (RightKind.REPLY, {"rr/xReply"}, {"rq/xRequest"}),
        (RightKind.REQUEST, {"rq/xRequest"}, {"rr/xReply"}),
        (
            RightKind.EXECUTE,
            {
                "rr/x/_action/send_goalReply",
                "rr/x/_action/cancel_goalReply",
                "rr/x/_action/get_resultReply",
                "rt/x/_action/feedback",
                "rt/x/_action/status",
            },
            {
                "rq/x/_action/send_goalRequest",
                "rq/x/_action/cancel_goalRequest",
                "rq/x/_action/get_resultRequest",
            },
        ),
    ],
)
def test_a_right_is_the_topics_of_dds_behind_it(kind, publish, subscribe):
    found = dds_rights([AccessRight(kind, "/x")])
    assert found.publish == {"ros_discovery_info", *publish}
    assert found.subscribe == {"ros_discovery_info", *subscribe}


def test_a_client_of_an_action_does_what_its_server_does_not():
    server = dds_rights([AccessRight(RightKind.EXECUTE, "/x")])
    client = dds_rights([AccessRight(RightKind.CALL, "/x")])
    assert (client.publish, client.subscribe) == (server.subscribe, server.publish)


@given(NAMES, NAMES, TEXT)
def test_permissions_are_read_as_they_were_written_whatever_the_names(publish, subscribe, enclave):
    written = permissions_of(publish, subscribe, enclave)
    assert parse_permissions(permissions_xml(written), enclave, "x") == written


def test_permissions_deny_what_they_do_not_name():
    root = ET.fromstring(permissions_xml(permissions_of({"rt/a"}, {"rt/b"})))
    (grant,) = root.iter("grant")
    assert [each.tag for each in grant] == ["subject_name", "validity", "allow_rule", "default"]
    assert grant.findtext("default") == "DENY"
    assert grant.findtext("subject_name") == "CN=/nav"
    assert grant.findtext("validity/not_before") == "2026-03-01T12:30:00"


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"<dds",
        b"<dds/>",
        b'<!DOCTYPE x [<!ENTITY a "b">]><dds/>',
        permissions_xml(permissions_of(enclave="/other")),
        permissions_xml(permissions_of()).replace(b"<id>3", b"<id>three"),
        permissions_xml(permissions_of()).replace(b"2026-03-01", b"yesterday"),
    ],
)
def test_what_is_no_permission_is_refused(text):
    with pytest.raises(InputError, match=r"^x: "):
        parse_permissions(text, "/nav", "x")


def test_permissions_that_allow_the_rest_allow_everything():
    text = permissions_xml(permissions_of({"rt/a"})).replace(b"DENY", b"ALLOW")
    assert parse_permissions(text, "/nav", "x").rights.publish == {"rt/a", "*"}


def test_permissions_for_a_range_of_domains_are_for_each():
    text = permissions_xml(permissions_of()).replace(
        b"<id>3</id>", b"<id_range><min>2</min><max>4</max></id_range>"
    )
    assert parse_permissions(text, "/nav", "x").domains == {2, 3, 4}


@pytest.mark.parametrize("protection", Protection)
def test_nobody_joins_without_a_certificate(protection):
    root = ET.fromstring(governance_xml(5, protection))
    assert root.findtext(".//allow_unauthenticated_participants") == "false"
    assert root.findtext(".//enable_join_access_control") == "true"
    assert root.findtext(".//enable_write_access_control") == "true"
    assert root.findtext(".//enable_read_access_control") == "true"
    assert root.findtext(".//domains/id") == "5"
    assert root.findtext(".//metadata_protection_kind") == protection.name


def test_the_policy_has_an_enclave_for_each_process():
    root = ET.fromstring(policy_xml(access_of("/odom")))
    assert root.get("version") == "0.2.0"
    paths = [each.get("path") for each in root.iter("enclave")]
    assert paths == ["/rtron_guard", "/rtron_verify", "/base", "/nav"]
    (nav,) = root.iterfind(".//enclave[@path='/nav']/profiles/profile")
    assert (nav.get("ns"), nav.get("node")) == ("/", "nav")
    published = {each.text for each in nav.iterfind("topics[@publish='ALLOW']/topic")}
    assert published == {"/odom", "/rosout", "/parameter_events", "/rtron/cmd_vel/flow1"}
    assert {each.tag for each in nav} <= {"topics", "services", "actions"}
