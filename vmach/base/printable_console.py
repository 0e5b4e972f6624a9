"""A console of rich: the strings that it is given never steer the terminal."""

from __future__ import annotations

from typing import Any

from rich.console import Console

from vmach.base.terminal import printable

__all__ = ["PrintableConsole"]


class PrintableConsole(Console):
    """A console whose strings are made printable; its own colours and bars are drawn."""

    def render_str(self, text: str, **style: Any) -> Any:
        return super().render_str(printable(text), **style)
