"""Q-DAS ASCII transfer format: K fields of part, characteristics and values in one file.

Source: Q-DAS ASCII Transfer Format, the key fields of its public description: K0100 number of
characteristics, K1001 to K1004 the part, K2001 ... K2142 a characteristic, K0001 ... K0014 values.
"""

from __future__ import annotations

from datetime import datetime

from vmach.features.result import FeatureResult
from vmach.report.exchange.formats import reported
from vmach.report.result import RunRecord

__all__ = ["content"]

#: decimal places of all values, mm
_DECIMALS = 6
#: a limit that nature sets, as zero is for a form
_NATURAL = 2


def content(run: RunRecord, **more: object) -> bytes:
    """The file as text, Latin-1, lines ended by CR LF."""
    shown = [result for result in run.features if reported(result) is not None]
    lines = [
        f"K0100 {len(shown)}",
        f"K1001 {_one_line(run.part or run.title)}",
        f"K1002 {_one_line(run.title)}",
    ]
    if run.revision:
        lines.append(f"K1004 {_one_line(run.revision)}")
    for number, result in enumerate(shown, 1):
        lines += _characteristic(number, result)
    for number, result in enumerate(shown, 1):
        lines += _value(number, result, run)
    return ("\r\n".join(lines) + "\r\n").encode("latin-1", "replace")


def _characteristic(number: int, result: FeatureResult) -> list[str]:
    fields = {
        "K2001": str(number),
        "K2002": _one_line(f"{result.feature}: {result.title}"),
        "K2022": str(_DECIMALS),
        "K2101": f"{result.nominal_mm:.{_DECIMALS}f}",
        "K2110": f"{result.lower_mm or 0.0:.{_DECIMALS}f}",
        "K2111": f"{result.upper_mm:.{_DECIMALS}f}",
    }
    if result.lower_mm is None:
        fields["K2120"] = str(_NATURAL)
    fields["K2142"] = "mm"
    return [f"{key}/{number} {text}" for key, text in fields.items()]


def _value(number: int, result: FeatureResult, run: RunRecord) -> list[str]:
    fields = {"K0001": f"{reported(result).value_mm:.{_DECIMALS}f}"}
    if run.started_at:
        when = datetime.fromisoformat(run.started_at)
        fields["K0004"] = when.strftime("%d.%m.%Y/%H:%M:%S")
    if run.serial:
        fields["K0014"] = _one_line(run.serial)
    return [f"{key}/{number} {text}" for key, text in fields.items()]


def _one_line(text: str) -> str:
    return " ".join(text.split())
