"""No sentence is longer than 35 words: pages, READMEs, docstrings and messages."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LONGEST_WORDS = 35

#: literals that are files, not sentences
FILES_IN_CODE = {
    "vmach/commands/warm_up.py",
    "vmach/diagnosis/proposals/effect_text.py",
    "vmach/effects/skeleton.py",
}

_FENCED = re.compile(r"```.*?```", re.DOTALL)
_PARAGRAPH = re.compile(r"\n\s*\n")
_ITEM = re.compile(r"^\s*(?:[*-]|\d+\.)\s", re.MULTILINE)
_SENTENCE = re.compile(r"(?<=[.!?:;])\s+")
#: lines of an example
_CODE = re.compile(r"^\s*(?:>>>|\.\.\.).*$", re.MULTILINE)
#: sections and parameters of a NumPy docstring
_SECTION = re.compile(r"\n(?=\s*\w[\w, ]* : )|\n\s*-{3,}\s*\n")

PAGES = sorted(
    [*(ROOT / "docs").rglob("*.md"), *(ROOT / "samples").rglob("*.md"), *ROOT.glob("*.md")]
)


def long_sentences(text: str) -> list[str]:
    """Sentences of a text of paragraphs and lists that are too long."""
    paragraphs = (part for block in _PARAGRAPH.split(text) for part in _ITEM.split(block))
    sentences = (s for part in paragraphs for s in _SENTENCE.split(" ".join(part.split())))
    return [s for s in sentences if len(s.split()) > LONGEST_WORDS]


def _literal(node: ast.AST) -> str:
    """The text of a string, values in it as one word each."""
    if isinstance(node, ast.JoinedStr):
        return "".join(str(v.value) if isinstance(v, ast.Constant) else "0" for v in node.values)
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_pages(page):
    text = _FENCED.sub("", page.read_text(encoding="utf-8"))
    prose = "\n".join(line for line in text.split("\n") if not line.lstrip().startswith("|"))
    assert long_sentences(prose) == []


@pytest.mark.parametrize("room", ["gcode", "stock", "vmach"])
def test_docstrings_and_messages(room):
    long = {}
    for path in sorted((ROOT / room).rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            text = _SECTION.sub("\n\n", _CODE.sub("\n", _literal(node)))
            if name not in FILES_IN_CODE and not text.lstrip().startswith("<"):
                for sentence in long_sentences(text):
                    long[f"{name}:{node.lineno}"] = sentence
    assert long == {}


def test_a_long_sentence_is_found():
    assert long_sentences("word " * 36) == [" ".join(["word"] * 36)]
    assert long_sentences("word " * 20 + "end. " + "word " * 20) == []
