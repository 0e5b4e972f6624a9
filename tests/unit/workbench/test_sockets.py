"""A real server and sockets that mean it no good: it goes on serving."""

import http.client
import re
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest
import uvicorn

from vmach.workbench import bounded_http
from vmach.workbench.access import Access
from vmach.workbench.server import build_server
from vmach.workbench.session import Session

MANY = 1000
PATIENCE_S = 120


@pytest.fixture(scope="module")
def served():
    """A workbench without a job on a port of its own, with short patience."""
    patience = pytest.MonkeyPatch()
    patience.setattr(bounded_http, "_TO_ASK_S", 1.0)
    patience.setattr(bounded_http, "_TO_SEND_S", 1.0)
    listening = socket.socket()
    listening.bind(("127.0.0.1", 0))
    access = Access.new(listening.getsockname()[1])
    app = build_server(Session(), access)
    config = uvicorn.Config(app, http=bounded_http.BoundedHttp, ws="none", log_level="critical")
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, args=([listening],))
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield access, server
    server.should_exit = True
    thread.join()
    patience.undo()


def state_of(access):
    """What a page gets that asks for the state."""
    connection = http.client.HTTPConnection("127.0.0.1", access.port, timeout=PATIENCE_S)
    connection.request("GET", "/api/state", headers={"x-vmach-token": access.token})
    answer = connection.getresponse()
    answer.read()
    connection.close()
    return answer.status


def until(holds):
    """Wait until something holds, on a slow machine as well."""
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end, "it does not come to hold"
        time.sleep(0.05)


def is_closed(one):
    """Whether the server takes no further byte of a socket."""
    try:
        one.send(b"x")
    except OSError:
        return True
    return False


def test_a_thousand_sockets_that_ask_nothing(served):
    access, server = served
    crowd = []
    for _ in range(MANY):
        one = socket.create_connection(("127.0.0.1", access.port), timeout=PATIENCE_S)
        crowd.append(one)
    assert state_of(access) == 200
    until(lambda: len(server.server_state.connections) <= bounded_http._MOST_SOCKETS + 1)
    for one in crowd:
        one.close()
    assert state_of(access) == 200


def test_sockets_that_ask_a_byte_at_a_time_are_closed(served):
    access, _ = served
    address = ("127.0.0.1", access.port)
    slow = [socket.create_connection(address, timeout=PATIENCE_S) for _ in range(20)]
    until(lambda: all([is_closed(one) for one in slow]))
    for one in slow:
        one.close()
    assert state_of(access) == 200


def test_content_that_never_ends_is_cut_off(served):
    access, _ = served
    one = socket.create_connection(("127.0.0.1", access.port), timeout=PATIENCE_S)
    head = (
        f"PUT /api/files/a.csv HTTP/1.1\r\nHost: 127.0.0.1:{access.port}\r\nx-vmach: 1\r\n"
        f"x-vmach-token: {access.token}\r\nContent-Length: 1000000\r\n\r\n"
    )
    one.sendall(head.encode() + b"x")
    until(lambda: is_closed(one))
    one.close()
    assert state_of(access) == 200


GARBAGE = [b"\0" * 4000, b"GET / HTTP/9.9\r\n\r\n", b"GET " + b"a" * 100_000, b"\xff\xfe\r\n\r\n",
           b"POST / HTTP/1.1\r\nContent-Length: -5\r\n\r\n", b"\r\n" * 3000]  # fmt: skip


@pytest.mark.parametrize("garbage", GARBAGE, ids=range(len(GARBAGE)))
def test_what_is_no_http_is_refused(served, garbage):
    access, _ = served
    for _ in range(20):
        with socket.create_connection(("127.0.0.1", access.port), timeout=PATIENCE_S) as one:
            try:
                one.sendall(garbage)
                one.shutdown(socket.SHUT_WR)
                said = one.recv(1000)
            except OSError:
                said = b""
        assert b"200 OK" not in said
    assert state_of(access) == 200


def test_browsers_that_leave_while_they_are_answered(tmp_path):
    command = [sys.executable, "-P", "-m", "vmach", "open", "--no-browser"]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as process:
        found = re.search(r":(\d+)/\?token=(\S+)", process.stdout.readline())
        access = Access(port=int(found[1]), token=found[2])
        asked = (
            f"GET /api/state HTTP/1.1\r\nHost: 127.0.0.1:{access.port}\r\n"
            f"x-vmach-token: {access.token}\r\n\r\n"
        )
        for _ in range(50):
            with socket.create_connection(("127.0.0.1", access.port), timeout=PATIENCE_S) as one:
                one.sendall(asked.encode())
        assert state_of(access) == 200
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE_S) in (0, 130)


def test_it_listens_on_this_machine_alone(monkeypatch):
    from vmach.workbench import launch

    found = launch._listen(0)
    try:
        assert found.getsockname()[0] == "127.0.0.1"
        address = found.getsockname()
        socket.create_connection(address, timeout=PATIENCE_S).close()  # it listens already
    finally:
        found.close()
