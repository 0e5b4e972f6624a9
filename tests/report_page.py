"""A page as a browser would take it apart, and what no page may do."""

from __future__ import annotations

import html.parser
import re


class Page(html.parser.HTMLParser):
    """Collects the elements, the attributes and the contents of the scripts of a page."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.scripts, self.style, self.text, self._open = [], [], "", "", None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        self._open = tag
        if tag == "script":
            self.scripts.append("")

    def handle_endtag(self, tag):
        self._open = None

    def handle_data(self, data):
        if self._open == "script":
            self.scripts[-1] += data
        elif self._open == "style":
            self.style += data
        else:
            self.text += data


def assert_asks_for_nothing(page: Page) -> None:
    """No element, script or style asks the network for anything; the page forbids it as well."""
    for tag, attributes in page.elements:
        assert tag not in {"link", "iframe", "object", "embed", "base", "form", "audio", "video"}
        assert not any(
            value and not value.startswith(("data:", "#"))
            for name, value in attributes.items()
            if name in {"src", "href", "action", "srcset", "data", "poster", "xlink:href"}
        )
    code = "".join(page.scripts[:1] + page.scripts[2:]) + page.style  # the second is the payload
    assert not re.search(
        r"https?:|//\w+\.\w|\bfetch\(|XMLHttpRequest|WebSocket|import\(|url\(", code
    )
    policy = next(a["content"] for t, a in page.elements if a.get("http-equiv"))
    assert policy.startswith("default-src 'none'")
