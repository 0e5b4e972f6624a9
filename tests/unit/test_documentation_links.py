"""Every page of the documentation is reached from the README, and every link leads somewhere."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")


def targets(page):
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        if "://" not in target:
            yield (page.parent / target).resolve()


def test_links_lead_to_files_and_all_pages_are_reached():
    reached, waiting = set(), [ROOT / "README.md"]
    while waiting:
        page = waiting.pop()
        reached.add(page)
        for target in targets(page):
            assert target.exists(), f"{page.relative_to(ROOT)} links to {target}"
            if target.suffix == ".md" and target not in reached:
                waiting.append(target)
    assert not set((ROOT / "docs").rglob("*.md")) - reached


def test_names_of_modules_in_the_pages_are_those_of_the_code():
    pages = [*(ROOT / "docs").rglob("*.md"), ROOT / "README.md"]
    for page in pages:
        text = page.read_text(encoding="utf-8")
        for dotted in re.findall(r"`((?:vmach|gcode|stock)(?:\.[a-z_0-9]+)+)", text):
            parts = dotted.split(".")
            place = ROOT.joinpath(*parts[:2])
            inside = place.with_suffix(".py").exists() or place.is_dir()
            named = re.search(rf"\b{parts[1]}\b", (ROOT / parts[0] / "__init__.py").read_text())
            assert inside or named, f"{page.relative_to(ROOT)}: {dotted}"
