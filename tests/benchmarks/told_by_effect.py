"""Counts by effect: how often each is told where it is hidden, and where it is not."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

__all__ = ["print_told_by_effect"]

#: what says the same of a hidden cause: the table of its axis, the length of a tool that slipped
#: before its first readings
_TABLES = ("scale", "squareness", "gravity_sag", "reflector", "missing_table")
_AS_WELL = dict.fromkeys(_TABLES, "component") | {"tool_slip": "tool_length"}
_HIDDEN = re.compile(r"(\w+) (\w*) \{")
_SAID = re.compile(r"(\w+)(?: [A-Z]\w*)?(?: \[([\w,]+)\])?")


@dataclass(frozen=True)
class _Case:
    """Names of what is hidden in a case, and of what is said: of each the first, and all."""

    hidden: tuple[str, ...]
    said: tuple[tuple[str, tuple[str, ...]], ...]

    @classmethod
    def of(cls, row: dict) -> _Case:
        """The case of a row of counts."""
        said = row["said"].partition(": ")[2].rpartition(" (")[0]
        entries = [_SAID.match(one) for one in said.split("; ")]
        return cls(
            tuple(name for name, _ in _HIDDEN.findall(row["hidden"])),
            tuple(
                (m[1], tuple((m[2] or m[1]).split(","))) for m in entries if m and m[1] != "unknown"
            ),
        )

    def matched(self) -> Iterator[tuple[str | None, tuple[str, ...] | None]]:
        """Each hidden effect with the names that answer it, or None; then what is false."""
        left, open_hidden = list(self.said), list(self.hidden)
        for accepts in (self._by_name, self._in_class, self._as_well):
            for name in tuple(open_hidden):
                answer = next((one for one in left if accepts(name, one)), None)
                if answer is not None:
                    left.remove(answer)
                    open_hidden.remove(name)
                    yield name, answer[1]
        for name in open_hidden:
            yield name, None
        for first, _ in left:
            yield None, (first,)

    @staticmethod
    def _by_name(name: str, said: tuple[str, tuple[str, ...]]) -> bool:
        return said[0] == name

    @staticmethod
    def _in_class(name: str, said: tuple[str, tuple[str, ...]]) -> bool:
        return name in said[1]

    @staticmethod
    def _as_well(name: str, said: tuple[str, tuple[str, ...]]) -> bool:
        return _AS_WELL.get(name) in said[1]


def print_told_by_effect(rows: list[dict]) -> None:
    """A line of Markdown for each effect, of cases that hide known effects only."""
    hidden, alone, in_class, false = Counter(), Counter(), Counter(), Counter()
    instead: dict[str, Counter] = {}
    for row in rows:
        found = list(_Case.of(row).matched())
        wrong = [names[0] for name, names in found if name is None and names]
        false.update(wrong)
        for name, names in found:
            if name is None:
                continue
            hidden[name] += 1
            if names is None:
                instead.setdefault(name, Counter()).update(wrong)
            else:
                (alone if len(names) == 1 else in_class)[name] += 1
    print(
        "| effect | hidden | told alone | in a class | not told | told falsely in its case "
        "| told falsely, in all cases |"
    )
    print("|---|---|---|---|---|---|---|")
    for name in sorted({*hidden, *false}):
        told = alone[name] + in_class[name]
        others = ", ".join(f"{o} {n}" for o, n in instead.get(name, Counter()).most_common())
        print(
            f"| {name} | {hidden[name]} | {alone[name]} | {in_class[name]} "
            f"| {hidden[name] - told} | {others} | {false[name]} |"
        )
