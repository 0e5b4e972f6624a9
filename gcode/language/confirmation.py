"""Which words of a control an independent truth has confirmed, and which it has not.

Each dialect says it once, as data (`Dialect.confirmed`); the table of the documentation and the
note of a program are made from that.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

__all__ = ["TRUTHS", "confirmation_table", "unconfirmed_words"]

#: name of a truth -> what it is, and the tests that compare with it
TRUTHS: dict[str, tuple[str, tuple[str, ...]]] = {
    "manual": ("rules and figures of the maker's manuals, computed by hand",
               ("test_fanuc_manual.py", "test_klartext_manual.py", "test_sinumerik_manual.py",
                "test_drilling_cycles.py", "test_common_words.py", "test_words_one_by_one.py",
                "test_haas_cycles.py", "test_soft_approach.py")),
    "closed form": ("walls, floors, places and frames in closed form",
                    ("test_klartext_cycles.py", "test_klartext_contour_cycles.py",
                     "test_sinumerik_language.py", "test_corners_and_scales.py",
                     "test_haas_cycles.py", "test_face_cycles.py",
                     "test_klartext_thread_cycles.py", "test_soft_approach.py")),
    "posts": ("36 paths that FreeCAD 0.20 posted", ("test_freecad_posts.py",)),
    "public posts": ("what posts that their makers published write and mean, computed by hand",
                     ("test_okuma.py",)),
    "public programs": ("programs and manuals that others published: the order of arguments",
                        ("test_okuma.py", "test_face_cycles.py", "test_sinumerik_language.py")),
    "one part": ("one part programmed by hand for three controls",
                 ("test_one_part_three_controls.py",)),
    "fanuc": ("the same reader as FANUC's, whose words are confirmed above", ()),
    "no motion": ("nothing to confirm: the word moves nothing", ()),
}  # fmt: skip


def _words(said: str) -> list[str]:
    return [word.strip() for word in said.split(";") if word.strip()]


def unconfirmed_words(used: Iterable[str], confirmed: Mapping[str, str]) -> list[str]:
    """Words that no truth covers, in the order of their first use.

    Parameters
    ----------
    used : iterable of str
    confirmed : mapping of str to str
        Truth -> words with semicolons between them; empty for a dialect that keeps no table.
    """
    known = {word for said in confirmed.values() for word in _words(said)}
    return [word for word in used if word not in known] if known else []


def confirmation_table(confirmed: Mapping[str, Mapping[str, str]]) -> str:
    """Rows of the documentation: controls, truth, words; words of an earlier row stand there only.

    Parameters
    ----------
    confirmed : mapping
        Name of a dialect -> its table.
    """
    controls: dict[tuple[str, str], list[str]] = {}
    for name, table in confirmed.items():
        for truth, said in table.items():
            controls.setdefault((truth, ", ".join(_words(said))), []).append(name)
    rows = ["| control | confirmed by | words |", "|---|---|---|"]
    first: dict[str, str] = {}
    for (truth, words), names in controls.items():
        what = TRUTHS[truth][0]
        cell = f"those of {first[words]}" if words in first else words
        first.setdefault(words, f"{names[0]} by {what}")
        rows.append(f"| {', '.join(names)} | {what} | {cell} |")
    return "\n".join(rows)
