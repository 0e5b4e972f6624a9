"""Explanations that need more than nature is likely to bring at once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence

from vmach.diagnosis.findings import Finding

__all__ = ["is_contrived"]

#: more effects at once than this are not named
_MOST_AT_ONCE = 3
#: nor this many of one tool: it has broken, and each of them tells a part of it
_TOO_MANY_OF_A_TOOL = 3
#: nor this many that can take nearly any shape
_TOO_MANY_FLEXIBLE = 2


def is_contrived(findings: Sequence[Finding], *, expected: Collection[str] = ()) -> bool:
    """Whether so many effects at once are more likely to imitate something unknown.

    Too many are: more than three effects; three of one tool; two flexible ones; a flexible one
    among three; three effects of two kinds of which two are slow or flexible.

    Parameters
    ----------
    findings : sequence of Finding
    expected : collection of str
        Labels of those that are known to be there, as tables that were never measured; they do
        not count as flexible.
    """
    of_tools = Counter(
        f.target for f in findings if f.effect is not None and f.effect.is_of_one_tool
    )
    if max(of_tools.values(), default=0) >= _TOO_MANY_OF_A_TOOL:
        return True
    surprises = [f.effect for f in findings if f.effect is not None and f.label not in expected]
    flexible = sum(effect.is_flexible for effect in surprises)
    if flexible >= _TOO_MANY_FLEXIBLE:
        return True
    at_once = len({f.name for f in findings})
    if at_once >= _MOST_AT_ONCE or len(findings) > _MOST_AT_ONCE:
        return flexible > 0 or at_once > _MOST_AT_ONCE
    slow = sum(f.effect.is_slow for f in findings if f.effect is not None)
    return len(findings) > 2 and flexible + slow > 1
