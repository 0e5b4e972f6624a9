"""Write the tables of effects.md and laws.md anew, from the classes of the effects.

    .venv/bin/python docs/make_effect_tables.py

A class in ``vmach/effects/laws/`` says everything that its rows hold.
"""

from __future__ import annotations

import re
from pathlib import Path

from vmach.effects import Effect, catalogue

DOCS = Path(__file__).resolve().parent
#: what begins and ends a table that is written here
BEGIN, END = "<!-- made by make_effect_tables.py -->\n", "<!-- end -->\n"
#: targets that a job names: its tools, its further work offsets
FROM_JOB = {"tool": "T1 ...", "workpiece": "G55 ..."}
#: of targets that are told one by one; more are told as the first and the last
MANY = 5


def main() -> None:
    """Write both tables."""
    for page, table in (("effects.md", catalogue_table()), ("laws.md", law_table())):
        path = DOCS / page
        path.write_text(with_table(path.read_text(encoding="utf-8"), table), encoding="utf-8")


def with_table(page: str, table: str) -> str:
    """The page with another table between its marks."""
    before, rest = page.split(BEGIN)
    return before + BEGIN + table + END + rest.split(END, 1)[1]


def catalogue_table() -> str:
    """A row for each effect: what it acts on, its parameters, what a part shows of it."""
    rows = ["| effect | target | parameters | what shows |", "|---|---|---|---|"]
    for effect in sorted(catalogue().values(), key=room):
        rows.append(
            f"| `{effect.name}` | {targets(effect)} | {parameters(effect)} | {effect.shows_as} |"
        )
    return "\n".join(rows) + "\n"


def law_table() -> str:
    """A row for each effect: the number of its equation, and the equation."""
    rows = ["| no. | effect | e |", "|---|---|---|"]
    for effect in sorted(catalogue().values(), key=number):
        rows.append(f"| ({number(effect)}) | `{effect.name}` | {effect.law} |")
    return "\n".join(rows) + "\n"


def number(effect: Effect) -> int:
    """Of its equation."""
    found = re.match(r"equation \((\d+)\)", effect.source)
    assert found is not None
    return int(found[1])


def room(effect: Effect) -> tuple[str, int]:
    """Geometry, heat, servo, tool, workpiece; in each of them the commonest first."""
    return type(effect).__module__.split(".")[-2], -effect.commonness


def parameters(effect: Effect) -> str:
    """Their names; what a job may leave out is marked."""
    needed = {name for target in effect.targets or ("",) for name in effect.needed(target)}
    return ", ".join(
        f"`{p.name}`" + (" (optional)" if p.name not in needed else "") for p in effect.parameters
    )


def targets(effect: Effect) -> str:
    """What it can act on."""
    if not effect.targets:
        return FROM_JOB[room(effect)[0]]
    if len(effect.targets) > MANY:
        return f"{effect.targets[0]} ... {effect.targets[-1]}"
    return ", ".join(effect.targets)


if __name__ == "__main__":
    main()
