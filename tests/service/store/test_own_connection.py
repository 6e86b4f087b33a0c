"""Connections to PostgreSQL end where the server does not answer, and when the database closes."""

import os
import socket
import ssl
from contextlib import closing
from pathlib import Path
from threading import Thread

import pytest
from sqlalchemy import make_url, text
from sqlalchemy.exc import DBAPIError

from rtron.errors import InputError
from rtron.service.store.database import Database

DESCRIPTORS = Path("/proc/self/fd")


@pytest.fixture
def database(postgresql):
    made = Database(postgresql.new_database())
    yield made
    made.close()


def open_sockets():
    """Return what is open, without waiting for garbage to be collected."""
    names = [os.path.realpath(each) for each in DESCRIPTORS.iterdir()]
    return {each for each in names if "socket:" in each}


def test_a_connection_answers(database):
    with database.own_connection(60) as connection:
        assert connection.exec_driver_sql("SELECT 1").scalar() == 1


def test_a_server_that_does_not_answer_leaves_no_socket_open(database):
    with closing(socket.create_server(("127.0.0.1", 0))) as silent:
        database.url = make_url(f"postgresql+pg8000://a@127.0.0.1:{silent.getsockname()[1]}/b")
        before = open_sockets()
        with pytest.raises((DBAPIError, OSError)), database.own_connection(0.1):
            pass
        assert open_sockets() == before


def test_what_is_said_to_a_server_with_tls_is_encrypted(database, certificate):
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(*certificate)
    heard = []

    def serve(listening):
        plain, _ = listening.accept()
        plain.recv(8)
        plain.sendall(b"S")
        with context.wrap_socket(plain, server_side=True) as encrypted:
            heard.append(encrypted.recv(1000))

    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        port = server.getsockname()[1]
        database.url = make_url(f"postgresql+pg8000://ann:secret@127.0.0.1:{port}/b")
        thread = Thread(target=serve, args=[server])
        before = open_sockets()
        thread.start()
        with pytest.raises(DBAPIError), database.own_connection(60):
            pass
        thread.join()
        assert open_sockets() == before
    assert b"user\0ann\0" in heard[0]


def test_a_server_that_is_not_there_is_an_error_of_the_database(database):
    with closing(socket.create_server(("127.0.0.1", 0))) as gone:
        port = gone.getsockname()[1]
    database.url = make_url(f"postgresql+pg8000://a@127.0.0.1:{port}/b")
    with pytest.raises(DBAPIError, match=f"127.0.0.1:{port}"), database.own_connection(60):
        pass


def test_a_connection_in_use_ends_when_it_is_given_back_after_the_database_was_closed(postgresql):
    before = open_sockets()
    database = Database(postgresql.new_database())
    with database.session() as session:
        session.execute(text("SELECT 1"))
        database.close()
        assert len(open_sockets() - before) == 1
    assert open_sockets() == before


def test_a_socket_of_the_machine(postgresql, database):
    path = postgresql.socket_path
    database.url = make_url(f"postgresql+pg8000://postgres@/postgres?unix_sock={path}")
    with database.own_connection(60) as connection:
        address = connection.exec_driver_sql("SELECT inet_client_addr()").scalar()
    assert address is None
    database.url = make_url(f"postgresql+pg8000://postgres@/postgres?unix_sock={path}.gone")
    before = open_sockets()
    with pytest.raises(DBAPIError, match="gone: "), database.own_connection(60):
        pass
    assert open_sockets() == before


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("sslmode=require&a=b", "unknown options: a, sslmode"),
        ("unix_sock=/run/s", "a host and a socket"),
    ],
)
def test_options_that_would_not_be_followed_are_refused(options, message):
    with pytest.raises(InputError, match=message) as refused:
        Database(f"postgresql://ann:secret@127.0.0.1:1/b?{options}")
    assert "secret" not in str(refused.value)


def test_a_file_takes_no_options_of_a_server(tmp_path):
    for option in ("application_name=a", "unix_sock=/run/s"):
        with pytest.raises(InputError, match=f"unknown options: {option.split('=')[0]}") as refused:
            Database(f"sqlite:///{tmp_path}/a.db?{option}")
        assert refused.value.help == "a SQLite file takes none"
