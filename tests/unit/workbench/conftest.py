"""A small job with a hidden backlash, opened in the workbench."""

import json
import os
import time

import numpy as np
import pytest
from starlette.testclient import TestClient

from tests.measured_job import write_measured_job
from tests.unit.workbench.browser import context, folder, heard, served, tab  # noqa: F401
from vmach.workbench.access import Access
from vmach.workbench.server import build_server
from vmach.workbench.session import Session

#: how long a test waits for what must come; a slow machine costs time, never a test
PATIENCE_S = 300


def replace(path, text):
    """Write a file in one step, as an editor does: nobody ever reads half of it."""
    fresh = path.with_name(f".{path.name}.new")
    fresh.write_text(text)
    os.replace(fresh, path)


@pytest.fixture(scope="session", autouse=True)
def no_trace_among_the_users_jobs(tmp_path_factory):
    """What was opened is remembered in a folder of the tests' own."""
    patch = pytest.MonkeyPatch()
    patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
    yield
    patch.undo()


@pytest.fixture(scope="session")
def measured_folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("bench")
    write_measured_job(made)
    return made


class Page:
    """What a page would ask: with the token, from its own origin."""

    def __init__(self, job):
        self.session = Session()
        if job is not None:
            self.session.open(job)
        self.access = Access.new(8000)
        self.closed = []
        app = build_server(self.session, self.access, shut_down=lambda: self.closed.append(True))
        self.client = TestClient(app, base_url="http://127.0.0.1:8000")
        self.headers = {"x-vmach-token": self.access.token, "x-vmach": "1"}

    def get(self, address, **headers):
        return self.client.get(address, headers=self.headers | headers)

    def post(self, address, what=None, **headers):
        return self.client.post(address, json=what or {}, headers=self.headers | headers)

    def put(self, address, content, **headers):
        return self.client.put(address, content=content, headers=self.headers | headers)

    def framed(self, answer):
        assert answer.status_code == 200, answer.text
        length = int.from_bytes(answer.content[:4], "little")
        return json.loads(answer.content[4 : 4 + length]), np.frombuffer(
            answer.content[4 + length :], "<f4"
        )

    def wait_for(self, kind):
        """The last run of a kind when it is over."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            runs = [r for r in self.get("/api/state").json()["runs"] if r["kind"] == kind]
            if runs and runs[-1]["state"] in ("done", "failed", "stopped"):
                return runs[-1]
            time.sleep(0.05)
        raise AssertionError(f"{kind} is not over")

    def wait_for_revision(self, last):
        """The number of what is read next, after the `last`."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            if (now := self.get("/api/state").json()["revision"]) != last:
                return now
            time.sleep(0.05)
        raise AssertionError("nothing was read again")


@pytest.fixture(scope="session")
def page(measured_folder):
    """The measured job, opened once for all tests that leave it as it is."""
    made = Page(measured_folder / "job.toml")
    with made.client:
        yield made
