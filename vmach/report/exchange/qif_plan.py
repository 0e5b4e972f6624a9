"""The plan of a QIF document: datums first, then feature by feature, the doubtful ones first.

Source: ISO 23952:2020 (QIF 3.0), schema QIFPlan.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from typing import Protocol

from vmach.features.result import FeatureResult
from vmach.features.verdict import Verdict
from vmach.report.exchange.formats import reported
from vmach.report.figures.features import used_share
from vmach.report.result import RunRecord

__all__ = ["add_plan"]

#: what is measured first
_RANK = {Verdict.FAILS: 0, Verdict.OPEN: 1, Verdict.CONFORMS: 2}


class Numbers(Protocol):
    """Identifiers of a document."""

    letters: dict[str, int]
    frames: dict[tuple[str, ...], int]

    def new(self) -> int:
        """The next one."""
        ...


def add_plan(
    root: ET.Element,
    run: RunRecord,
    shown: Sequence[FeatureResult],
    items: Sequence[int],
    numbers: Numbers,
) -> None:
    """Put the plan into a document, after its characteristics.

    Parameters
    ----------
    root : Element
    run : RunRecord
    shown : sequence of FeatureResult
    items : sequence of int
        Identifier of the characteristic item of each.
    numbers : Numbers
        Identifiers; those of datums by their letters, of frames by their datums.
    """
    if not shown:
        return
    plan = ET.SubElement(root, "Plan")
    steps: dict[str, list[int]] = {}
    for place in sorted(range(len(shown)), key=lambda k: _order(shown[k])):
        steps.setdefault(shown[place].feature, []).append(place)
    told = ET.SubElement(plan, "WorkInstructions", {"n": str(len(steps))})
    instructions = {}
    for feature, places in steps.items():
        instructions[feature] = numbers.new()
        made = ET.SubElement(told, "TextInstruction", {"id": str(instructions[feature])})
        text = ET.SubElement(made, "TextInstruction")
        text.text = _words(run, [shown[place] for place in places])
    measurands = _datum_measurands(plan, numbers)
    group = ET.SubElement(plan, "OrderedPlanRoot")
    holder = ET.SubElement(group, "Steps")
    if measurands:
        action = _step(holder, "MeasureSpecifiedMeasurands")
        _ids(action, "MeasurandIds", measurands)
    for feature, places in steps.items():
        action = _step(holder, "MeasureEvaluateSpecified")
        _ids(action, "WorkInstructionIds", [instructions[feature]])
        _ids(action, "CharacteristicItemIds", [items[place] for place in places])
    holder.set("n", str(len(holder)))


def _order(result: FeatureResult) -> tuple[int, float]:
    return _RANK[reported(result).verdict], -used_share(result)


def _words(run: RunRecord, results: Sequence[FeatureResult]) -> str:
    """What is expected of a feature and where to look: the point that decides, the NC line."""
    first = results[0]
    lines = [f"{first.feature} ({', '.join(first.faces)})" if first.faces else first.feature]
    for result in results:
        value = reported(result)
        lines.append(f"{result.title}: {value.value_mm:.4f} mm, {value.verdict}")
    if first.places:
        x, y, z = first.places[0].at_mm
        lines.append(f"decided at X {x:.3f} Y {y:.3f} Z {z:.3f}")
    if first.lines:
        line = first.lines[0].line
        lines.append(f"made by line {line}: {run.nc_text(line)}".rstrip(": "))
    return "; ".join(lines)


def _datum_measurands(plan: ET.Element, numbers: Numbers) -> list[int]:
    """One measurand for each datum of each frame."""
    pairs = [
        (numbers.letters[letter], frame)
        for labels, frame in numbers.frames.items()
        for label in labels
        for letter in label.split("-")
    ]
    if not pairs:
        return []
    table = ET.SubElement(plan, "Measurands", {"n": str(len(pairs))})
    made = []
    for definition, frame in pairs:
        made.append(numbers.new())
        one = ET.SubElement(table, "EstablishDatumMeasurand", {"id": str(made[-1])})
        ET.SubElement(one, "DatumDefinitionId").text = str(definition)
        ET.SubElement(one, "DatumReferenceFrameId").text = str(frame)
    return made


def _step(holder: ET.Element, name: str) -> ET.Element:
    numbered = ET.SubElement(holder, "NumberedPlanElement")
    ET.SubElement(numbered, "SequenceNumber").text = str(len(holder))
    return ET.SubElement(numbered, name)


def _ids(parent: ET.Element, name: str, numbers: Sequence[int]) -> None:
    table = ET.SubElement(parent, name, {"n": str(len(numbers))})
    for number in numbers:
        ET.SubElement(table, "Id").text = str(number)
