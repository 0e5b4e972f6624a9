"""Who is let in, and what the page cannot reach."""

import itertools

import pytest

OTHERS = {
    "another site": {"origin": "http://evil.example"},
    "a site of the same name on another port": {"origin": "http://127.0.0.1:9999"},
    "a name that another site gave this machine": {"host": "evil.example:8000"},
    "a form of another site": {"sec-fetch-site": "cross-site"},
    "a wrong token": {"x-vmach-token": "0" * 43},
    "no token": {"x-vmach-token": ""},
    "letters beyond ASCII": {"x-vmach-token": b"\xc3\xbc"},
}


@pytest.mark.parametrize("headers", OTHERS.values(), ids=OTHERS)
@pytest.mark.parametrize("address", ["/", "/api/state", "/api/values", "/static/app.js"])
def test_others_are_refused(page, address, headers):
    answer = page.get(address, **headers)
    assert answer.status_code == 403
    assert set(answer.json()) == {"error"}


def test_a_form_cannot_change_anything(page):
    assert page.post("/api/reload", **{"x-vmach": ""}).status_code == 403
    assert page.post("/api/reload", origin="http://evil.example").status_code == 403


def test_the_address_gives_a_cookie_and_leaves_the_token_behind(page):
    page.client.cookies.clear()
    answer = page.client.get(f"/?token={page.access.token}", follow_redirects=False)
    assert answer.status_code == 303 and answer.headers["location"] == "/"
    cookie = answer.headers["set-cookie"].lower()
    assert "httponly" in cookie and "samesite=strict" in cookie
    assert page.client.get("/").status_code == 200  # the client kept the cookie
    page.client.cookies.clear()
    assert page.client.get("/?token=wrong", follow_redirects=False).status_code == 403


def test_nothing_comes_from_elsewhere_and_nobody_frames_the_page(page):
    policy = page.get("/").headers["content-security-policy"]
    assert policy.startswith("default-src 'none'") and "frame-ancestors 'self'" in policy
    assert "unsafe" not in policy


LEADS_OUT = ["../secret.toml", "..%2fsecret.toml", "a/../../secret.toml", "/etc/passwd",
             "%2e%2e/secret.toml", "link.html", "..\\secret.toml", "\0", "x" * 5000]  # fmt: skip


@pytest.mark.parametrize("name", LEADS_OUT)
@pytest.mark.parametrize("where", ["/show/", "/download/", "/api/text?file="])
def test_no_file_outside_the_folder(page, measured_folder, where, name):
    secret = measured_folder.parent / "secret.toml"
    secret.write_text("secret")
    link = measured_folder / "link.html"
    if not link.is_symlink():
        link.symlink_to(secret)
    answer = page.get(where + name.replace("\0", "%00"))
    assert answer.status_code in (400, 404)
    assert "secret" not in answer.text.replace("secret.toml", "")


@pytest.mark.parametrize("name", ["..%2fnew.csv", "sub%2fnew.csv", ".hidden.csv", "new.exe",
                                  "part.nc", "n" * 200 + ".csv"])  # fmt: skip
def test_files_are_taken_into_the_folder_alone_and_replace_nothing(page, measured_folder, name):
    before = {path: path.read_bytes() for path in measured_folder.iterdir() if path.is_file()}
    assert page.put("/api/files/" + name, b"new").status_code in (400, 404)
    after = {path: path.read_bytes() for path in measured_folder.iterdir() if path.is_file()}
    assert after == before


def test_a_file_of_the_user_is_taken_whole(page, measured_folder):
    answer = page.put("/api/files/readings.csv", b"a,b\n1,2\n")
    assert answer.json() == {"file": "readings.csv", "bytes": 8}
    assert (measured_folder / "readings.csv").read_bytes() == b"a,b\n1,2\n"


def test_a_file_without_end_is_given_up_early(page, measured_folder, monkeypatch):
    monkeypatch.setattr("vmach.workbench.routes.files.MOST_UPLOADED", 10_000)
    taken = []

    def endless():
        while True:
            taken.append(1)
            yield b"x" * 1000

    answer = page.put("/api/files/huge.csv", itertools.islice(endless(), 10**5))
    assert answer.status_code == 400 and "10000" in answer.json()["error"]
    assert not (measured_folder / "huge.csv").exists()
    stated = page.put("/api/files/huge.csv", b"", **{"content-length": "1000000000"})
    assert stated.status_code == 400


BROKEN = [
    b"",
    b"[1]",
    b"{",
    b'{"effects": "backlash"}',
    b'{"effects": ["--help"]}',
    b"\xff",
    b'{"effects": ["a; rm"]}',
    b"[" * 100_000,
    b'{"effects": NaN}',
    b"1" * 100_000,
]


@pytest.mark.parametrize("content", BROKEN, ids=range(len(BROKEN)))
def test_broken_json_is_refused(page, content):
    for address in ("/api/add", "/api/what-if", "/api/open", "/api/check-effect"):
        answer = page.client.post(address, content=content, headers=page.headers)
        assert answer.status_code == 400 and answer.json()["error"]


@pytest.mark.parametrize("query", ["quantity=nothing", "model=x", "tolerance_um=-1",
                                   "tolerance_um=nan", "quantity=share:none"])  # fmt: skip
def test_wrong_questions_are_answered_with_what_is_accepted(page, query):
    answer = page.get("/api/values?" + query)
    assert answer.status_code == 400 and "accepted" in answer.json()["error"]


def test_words_of_the_page_are_no_options_of_a_command(page):
    for what in ({"dialect": "--report"}, {"aim": "x"}, {"resolution_mm": 1e9}, {"limit_um": "1"}):
        assert page.post("/api/compensate", what).status_code == 400
    assert page.post("/api/open", {"job": "/etc/passwd"}).status_code == 400
    assert page.post("/api/open", {"job": "../../job.toml"}).status_code == 400
