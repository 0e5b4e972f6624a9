"""The tour that makes the pictures of the documentation waits for what it looks at."""

import importlib.util
from pathlib import Path

import pytest

from tests.unit.workbench.browser import needs_browser

pytestmark = needs_browser

SCRIPT = Path(__file__).resolve().parents[3] / "docs" / "make_workbench_pictures.py"
#: another job is drawn; the job of the name comes, then its part, then the words "all of it"
PAGE = """<body data-ready="part"><b id="job-name">part-2</b><p></p><script>
const later = (ms, work) => setTimeout(work, ms), name = document.getElementById("job-name");
later(200, () => { name.textContent = "part"; document.body.dataset.ready = ""; });
later(600, () => {
  document.querySelector("p").textContent = "all of it"; document.body.dataset.ready = "part"; });
</script></body>"""


@pytest.fixture(scope="module")
def pictures():
    pytest.importorskip("playwright.sync_api", reason="no Playwright")
    spec = importlib.util.spec_from_file_location(SCRIPT.stem, SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_part_of_the_job_before_is_waited_for(context, pictures):
    page = context.new_page()
    page.set_content(PAGE)
    pictures.drawn_again(page, "part")
    assert page.locator("p").inner_text() == "all of it"
    page.close()
