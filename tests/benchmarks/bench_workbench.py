"""How fast the workbench answers, how much it sends, and what memory it takes.

    python tests/benchmarks/bench_workbench.py [--diagnoses 10] [--spacing 0.72] [--browser]

Opens a copy of the sample missing_effect and asks as a page does. Clock times are of an idle
machine only; the processor times of the two processes stand beside them.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from http.client import HTTPConnection, HTTPException
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: what a page asks for until it shows the part
FIRST = ["/", "/viewer/detail.js", "/viewer/scene.js", "/viewer/gestures.js", "/api/state",
         "/api/about", "/api/mesh", "/api/values", "/api/program", "/api/effects", "/api/measured",
         "/api/start"]  # fmt: skip


class Bench:
    """A workbench in a process of its own, asked as its page asks."""

    def __init__(self, job: Path) -> None:
        self.began = time.perf_counter()
        words = [sys.executable, "-m", "vmach", "open", str(job), "--no-browser"]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        found = re.search(r":(\d+)/\?token=(\S+)", line)
        assert found is not None, line
        self.port, self.token = int(found[1]), found[2]

    def ask(self, address: str, what: dict | None = None) -> bytes:
        connection = HTTPConnection("127.0.0.1", self.port, timeout=600)
        headers = {"x-vmach-token": self.token, "x-vmach": "1"}
        method, content = ("GET", None) if what is None else ("POST", json.dumps(what))
        connection.request(method, address, body=content, headers=headers)
        answer = connection.getresponse()
        told = answer.read()
        assert answer.status == 200, told
        return told

    def processes(self) -> dict[str, int]:
        """Server and model, by their numbers."""
        (loader,) = [p for p in children(self.process.pid) if "forkserver" in command(p)]
        return {"server": self.process.pid, "loader": loader, "model": children(loader)[-1]}

    def memory_mb(self) -> dict[str, float]:
        found = {}
        for name, pid in self.processes().items():
            text = Path(
                f"/proc/{pid}/smaps_rollup"
            ).read_text()  # shared pages count by their share
            found[name] = int(re.search(r"^Pss:\s+(\d+)", text, re.MULTILINE)[1]) / 1024
        return found

    def processor_s(self) -> dict[str, float]:
        ticks = os.sysconf("SC_CLK_TCK")
        found = {}
        for name, pid in self.processes().items():
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            found[name] = (int(fields[11]) + int(fields[12])) / ticks
        return found


def children(pid: int) -> list[int]:
    told = (task / "children" for task in Path(f"/proc/{pid}/task").iterdir())
    return sorted(int(child) for file in told for child in file.read_text().split())


def command(pid: int) -> str:
    return Path(f"/proc/{pid}/cmdline").read_bytes().decode()


def main() -> None:
    given = argparse.ArgumentParser()
    given.add_argument("--diagnoses", type=int, default=10)
    given.add_argument("--spacing", type=float, help="of the inspected points, mm")
    given.add_argument("--browser", action="store_true", help="measure in Chromium, too")
    options = given.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_STATE_HOME"] = folder
        for name in ("missing_effect", "iso10791_7"):
            shutil.copytree(ROOT / "samples" / name, Path(folder) / name)
        job = Path(folder) / "missing_effect" / "job.toml"
        if options.spacing:
            job.write_text(job.read_text() + f"\n[inspection]\nspacing_mm = {options.spacing}\n")
        if options.browser:
            first_frames(job)
        bench = Bench(job)
        try:
            measure(bench, options.diagnoses, options.browser)
        finally:
            bench.process.terminate()
            bench.process.wait()


def measure(bench: Bench, diagnoses: int, browser: bool) -> None:
    static = sorted((ROOT / "vmach" / "workbench" / "static").iterdir())
    sent = sum(len(bench.ask(address)) for address in FIRST)
    took, cpu = time.perf_counter() - bench.began, bench.processor_s()
    sent += sum(len(bench.ask(f"/static/{path.name}")) for path in static if path.suffix != ".html")
    print(f"first picture: {took:.1f} s by the clock; processor: {told(cpu)} s")
    print(f"the page: {sent / 1e6:.2f} MB")
    repeat("slider", bench, "model", lambda k: bench.ask("/api/what-if", slider(k)))
    place = "/api/point?points=surface&x=0&y={}&z=0&i=0&j=0&k=1"
    repeat("pick", bench, "model", lambda k: bench.ask(place.format(k)))
    hostile(bench)
    if browser:
        seen(bench)
    print(f"memory (PSS): {told(bench.memory_mb())} MB")
    for number in range(1, diagnoses + 1):
        bench.ask("/api/diagnose", {})
        while True:
            runs = json.loads(bench.ask("/api/state"))["runs"]
            if runs[-1]["state"] not in ("waiting", "running"):
                break
            time.sleep(0.2)
        assert runs[-1]["state"] == "done", runs[-1]["message"]
        print(f"memory after {number} diagnoses: {told(bench.memory_mb())} MB", flush=True)


def hostile(bench: Bench, times: int = 1000) -> None:
    """Requests of others and of nobody: refused, and the page is served all the same."""
    own = {"x-vmach-token": bench.token, "x-vmach": "1"}
    kinds = [
        ("GET", "/api/state", {}, b""),
        ("GET", "/api/state", {"x-vmach-token": "0" * 43}, b""),
        ("GET", "/api/state", own | {"origin": "http://evil.example"}, b""),
        ("GET", "/api/state", own | {"host": "evil.example"}, b""),
        ("POST", "/api/reload", {"x-vmach-token": bench.token}, b"{}"),
        ("GET", "/show/..%2f..%2fetc%2fpasswd", own, b""),
        ("GET", "/download/%2e%2e/secret", own, b""),
        ("PUT", "/api/files/huge.csv", own | {"content-length": "1000000000"}, b"x"),
        ("POST", "/api/add", own, b"{" * 1000),
        ("POST", "/api/what-if", own, b'{"changes": [{"component": "E"}]}'),
    ]
    began, refused = time.perf_counter(), 0
    for k in range(times):
        method, address, headers, content = kinds[k % len(kinds)]
        connection = HTTPConnection("127.0.0.1", bench.port, timeout=60)
        with contextlib.suppress(OSError):
            connection.request(method, address, body=content or None, headers=headers)
        with contextlib.suppress(OSError, HTTPException):
            refused += 400 <= connection.getresponse().status < 500
        connection.close()
    bench.ask("/api/about")
    took = time.perf_counter() - began
    print(f"hostile requests: {refused} of {times} refused, still serving; {took:.1f} s")


@contextlib.contextmanager
def in_browser():
    """A page of Chromium, drawn by the processor."""
    from playwright.sync_api import sync_playwright

    flags = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader"]  # fmt: skip
    program = next(filter(None, map(shutil.which, ("chromium", "google-chrome"))))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=flags)
        page = browser.new_page(viewport={"width": 1400, "height": 900}, bypass_csp=True)
        page.set_default_timeout(600_000)
        yield page
        browser.close()


def first_frames(job: Path) -> None:
    """From the command to the first frame with the part; a browser is open, as it usually is."""
    for time_of_it in ("the first time", "again", "again"):
        with in_browser() as page:
            page.add_init_script(_FIRST_FRAME)
            page.goto("about:blank")
            began, bench = time.time(), Bench(job)
            page.goto(f"http://127.0.0.1:{bench.port}/?token={bench.token}", wait_until="commit")
            page.wait_for_function("window.firstFrame", polling=20)
            took, cpu = page.evaluate("window.firstFrame") / 1e3 - began, bench.processor_s()
            page.wait_for_selector("body[data-ready=part]")
            bench.process.terminate()
            bench.process.wait()
        print(f"first frame, {time_of_it}: {took:.1f} s by the clock; processor: {told(cpu)} s; "
              f"load {os.getloadavg()[0]:.1f}", flush=True)  # fmt: skip


#: the time of the first frame in which triangles were drawn, when its pixels are there
_FIRST_FRAME = """(() => {
  const kind = WebGL2RenderingContext.prototype, draw = kind.drawElements;
  kind.drawElements = function (...what) {
    draw.apply(this, what);
    kind.drawElements = draw;
    Promise.resolve().then(() => {
      this.readPixels(0, 0, 1, 1, this.RGBA, this.UNSIGNED_BYTE, new Uint8Array(4));
      requestAnimationFrame(() => setTimeout(() => { window.firstFrame = Date.now(); }, 0));
    });
  };
})();"""


def seen(bench: Bench, times: int = 20) -> None:
    """What somebody in front of the page waits for: the page, a slider, a pick."""
    with in_browser() as page:
        began = time.perf_counter()
        page.goto(f"http://127.0.0.1:{bench.port}/?token={bench.token}")
        page.wait_for_selector("body[data-ready=part]")
        print(f"seen: the page in {time.perf_counter() - began:.1f} s, the part being there")
        page.evaluate(_CLOCK)
        page.locator("#tab-what-if").click()
        page.get_by_label("Find an effect").fill("backlash y")
        page.get_by_label("backlash Y reversal").wait_for()
        print(f"{'seen, ms':10}{'all':>8}{'server':>8}{'renderer':>10}{'page':>8}")
        tell_seen("a slider", page, _SLIDER, times)
        page.locator("#tab-look").click()
        tell_seen("a pick", page, _PICK, times)


def tell_seen(name: str, page, act: str, times: int) -> None:
    """Medians: from the input to the frame, of which the answer, the renderer, and what is left."""
    rows = sorted(page.evaluate(act.replace("K", str(k))) for k in range(1, times + 1))
    total, server, renderer = (sorted(row[i] for row in rows)[times // 2] for i in range(3))
    page_ms = sorted(row[0] - row[1] - row[2] for row in rows)[times // 2]
    print(f"{name:10}{total:8.0f}{server:8.0f}{renderer:10.0f}{page_ms:8.0f}", flush=True)


#: adds up what drawing takes until its pixels are there
_CLOCK = """() => {
  const pixel = new Uint8Array(4);
  window.drawn_ms = 0;
  for (const name of ["draw", "drawQuickly"]) {
    const draw = Scene.prototype[name];
    Scene.prototype[name] = function () {
      const began = performance.now(), { gl } = this;
      draw.call(this);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      window.drawn_ms += performance.now() - began;
    };
  }
}"""
#: from the input to the first frame after the figures, or the point, have changed
_FRAME = """() => new Promise((done) => {
  const began = performance.now(), place = document.querySelector("PLACE");
  window.drawn_ms = 0;
  setTimeout(() => done([NaN, NaN, NaN]), 5000);
  new MutationObserver((_, me) => {
    me.disconnect();
    requestAnimationFrame(() => setTimeout(() => {
      const answers = performance.getEntriesByType("resource")
        .filter((one) => one.startTime >= began);
      const server = answers.reduce((sum, one) => sum + one.responseEnd - one.startTime, 0);
      done([performance.now() - began, server, window.drawn_ms]);
    }, 0));
  }).observe(place, { childList: true, subtree: true, characterData: true });
  performance.clearResourceTimings();
  ACT
})"""
_SLIDER = _FRAME.replace("PLACE", "#figures").replace("ACT", """
  const input = document.querySelector('[aria-label^="backlash Y reversal"]');
  input.value = 110 + K;
  input.dispatchEvent(new Event("input", { bubbles: true }));""")  # fmt: skip
_PICK = _FRAME.replace("PLACE", ".point").replace("ACT", """
  const canvas = document.querySelector("#canvas"), box = canvas.getBoundingClientRect();
  const at = { clientX: box.left + (0.45 + 0.005 * K) * box.width, button: 0, pointerId: 1,
    clientY: box.top + 0.5 * box.height, bubbles: true };
  canvas.setPointerCapture = () => {};
  for (const kind of ["pointerdown", "pointerup"])
    canvas.dispatchEvent(new PointerEvent(kind, at));""")  # fmt: skip


def slider(k: int) -> dict:
    size = {"reversal_um": 5.0 + 0.1 * k}
    return {"changes": [{"effect": "backlash", "target": "Y", "parameters": size}], "shown": {}}


def repeat(name: str, bench: Bench, process: str, ask, times: int = 50) -> None:
    ask(0)
    cpu, clock = bench.processor_s()[process], []
    for k in range(1, times + 1):
        began = time.perf_counter()
        ask(k)
        clock.append(1e3 * (time.perf_counter() - began))
    spent = 1e3 * (bench.processor_s()[process] - cpu) / times
    print(f"{name}: {sorted(clock)[times // 2]:.0f} ms by the clock, {spent:.0f} ms of processor")


def told(numbers: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:.1f}" for name, value in numbers.items())


if __name__ == "__main__":
    main()
