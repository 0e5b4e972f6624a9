"""DMIS output: a line for each requirement, and one for what was found.

Source: ISO 22093 (DMIS 5): nominal tolerances ``T(label)=TOL/...`` and actual ones ``TA(label)=``.
"""

from __future__ import annotations

import re

from vmach.features.result import FeatureResult
from vmach.features.verdict import Verdict
from vmach.report.exchange.formats import reported
from vmach.report.result import RunRecord

__all__ = ["content"]

_WORDS = {
    "size": "DIAM",
    "distance": "DISTB",
    "straightness": "STRGHT",
    "flatness": "FLAT",
    "roundness": "CIRLTY",
    "cylindricity": "CYLCTY",
    "profile of line": "PROFL",
    "profile": "PROFS",
    "parallelism": "PARLEL",
    "perpendicularity": "PERP",
    "angularity": "ANGLR",
    "position": "POS",
    "coaxiality": "CONCEN",
    "symmetry": "SYM",
    "circular runout": "CRNOUT",
    "total runout": "TRNOUT",
}
_STATUS = {Verdict.CONFORMS: "INTOL", Verdict.FAILS: "OUTOL", Verdict.OPEN: "UNKNOWN"}


def content(run: RunRecord, **more: object) -> bytes:
    """The file as text: ASCII, lines ended by CR LF as DMIS has them."""
    lines = [
        f"DMISMN/'{_plain(run.title)} by vmach',05.2",
        "UNITS/MM,ANGDEC",
        f"PN(PART)=PARTID/'{_plain(run.part or run.title)}'",
    ]
    if run.serial:
        lines.append(f"PS(SERIAL)=PARTSN/'{_plain(run.serial)}'")
    for number, result in enumerate(run.features, 1):
        value = reported(result)
        if value is None:
            continue
        label = f"{number:03d}_{_label(result)}"
        lines += [f"$$ {_plain(result.feature)}: {_plain(result.title)}", _nominal(label, result),
                  _actual(label, result)]  # fmt: skip
    return ("\r\n".join([*lines, "ENDFIL"]) + "\r\n").encode("ascii")


def _word(result: FeatureResult) -> str:
    if result.characteristic == "size":
        text = result.callout.lstrip()
        if text.startswith(("R", "SR")):
            return "RAD"
        return "WIDTH" if result.kind == "width" else "DIAM"
    return _WORDS[result.characteristic]


def _nominal(label: str, result: FeatureResult) -> str:
    word = _word(result)
    if result.lower_mm is not None:
        low, high = (limit - result.nominal_mm for limit in (result.lower_mm, result.upper_mm))
        limits = f"{low:.6f},{high:.6f}"
        if word == "DISTB":
            limits = f"NOMINL,{result.nominal_mm:.6f},{limits},PT2PT,AVG"
        return f"T({label})=TOL/{word},{limits}"
    parts = [f"{result.upper_mm:.6f}"]
    if word == "POS":
        parts = ["3D" if result.unit.startswith("S") else "2D", *parts, "RFS"]
    parts += [f"DAT({letter})" for letter in result.datums]
    return f"T({label})=TOL/{word},{','.join(parts)}"


def _actual(label: str, result: FeatureResult) -> str:
    value = reported(result)
    found = value.value_mm
    if result.lower_mm is not None:
        found -= result.nominal_mm
    return f"TA({label})=TOL/{_word(result)},{found:.6f},{_STATUS[value.verdict]}"


def _label(result: FeatureResult) -> str:
    """A label of letters, digits and underlines."""
    return re.sub(r"[^A-Z0-9]+", "_", _plain(result.feature).upper()).strip("_")[:40] or "F"


def _plain(text: str) -> str:
    """The text with ASCII letters only."""
    for letter, plain in (("Ø", "DIA "), ("±", "+-"), ("'", ""), ("−", "-")):
        text = text.replace(letter, plain)
    return text.encode("ascii", "replace").decode()
