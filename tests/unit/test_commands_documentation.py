"""The page of commands lists every command with all its options, and no others."""

from __future__ import annotations

import re
from pathlib import Path

import typer

from vmach.cli import app

DOCS = Path(__file__).parents[2] / "docs"


def commands(group, prefix=""):
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from commands(command, f"{prefix}{name} ")
        else:
            yield f"{prefix}{name}", command


def test_every_command_has_a_row_and_a_page():
    page = (DOCS / "commands.md").read_text(encoding="utf-8")
    rows = page.split("## Options")[0]
    for name, _ in commands(typer.main.get_command(app)):
        assert f"`{name}" in rows, name
    for target in re.findall(r"\]\(([\w/-]+\.md)\)", page):
        assert (DOCS / target).is_file(), target


def test_every_option_has_a_row_and_every_row_an_option():
    page = (DOCS / "commands.md").read_text(encoding="utf-8").split("## Options")[1]
    written, current = {}, None
    for name, options in re.findall(r"^\| (?:`([a-z0-9 ]+)`)? ?\| ([^|]+) \|", page, re.MULTILINE):
        current = name or current
        written.setdefault(current, set()).update(re.findall(r"--[a-z-]+", options))
    there = {
        name: {o for p in command.params for o in (*p.opts, *p.secondary_opts) if o[:2] == "--"}
        for name, command in commands(typer.main.get_command(app))
    }
    assert written == {name: options for name, options in there.items() if options}
