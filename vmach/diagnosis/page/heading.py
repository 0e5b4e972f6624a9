"""The words of diagnosis.html: its heading, what it means, values with their units."""

from __future__ import annotations

from vmach.diagnosis.diagnose import Diagnosis
from vmach.diagnosis.findings import Finding
from vmach.diagnosis.words import counted_as_of_measurement, expected, rounded, title_of
from vmach.effects import Effect
from vmach.machine import LINEAR_AXES

__all__ = ["chance_words", "headline", "quantity", "state_words"]

#: units that stand at the end of a parameter's name, as a page shows them
_UNITS = {
    "um": "µm",
    "mm": "mm",
    "ppm": "ppm",
    "urad": "µrad",
    "rad": "rad",
    "s": "s",
    "ms": "ms",
    "ms2": "ms²",
}


def chance_words(p: float) -> str:
    """How often chance alone would look like this."""
    if p < 1e-9:
        return "p < 10⁻⁹"
    return f"p = {p:.1g}" if p < 0.1 else f"p = {p:.2f}"


def quantity(
    parameter: str, value: float, interval: tuple[float, float]
) -> tuple[str, str, str, str]:
    """A value, the ends of its interval, and the unit that stands at the end of its name."""
    unit = _UNITS.get(parameter.rsplit("_", 1)[-1], "")
    value_text, low, high = (text.replace("-", "−") for text in rounded(value, interval))
    return value_text, low, high, unit


def headline(found: Diagnosis) -> tuple[str, str]:
    """The verdict as a heading, and what it means in a sentence or two."""
    rms = found.rms_um
    fell = (
        f"Measured minus predicted falls from {rms['before']:.2f} to {rms['after']:.2f} um RMS"
        f", where {expected(found.residuals)} make {rms['expected_noise']:.2f} um"
    )
    parts = ", ".join(f"{name} {size:.2f}" for name, size in found.remains_by_um.items())
    remains = f"{found.remains_um:.2f} um RMS of something else remain beside noise ({parts})"
    if found.verdict == "nothing":
        return (
            "The measurements agree with the model",
            f"Nothing is missing that they could show: measured minus predicted is "
            f"{rms['before']:.2f} um RMS, {expected(found.residuals)} make "
            f"{rms['expected_noise']:.2f} um."
            + f" {counted_as_of_measurement(found.of_device_um)}"
            * bool(found.of_device_um),
        )
    if found.verdict == "unknown":
        return (
            "Something real is left that no known effect clearly explains",
            f"Measured minus predicted is {rms['before']:.2f} um RMS, {expected(found.residuals)} "
            f"make {rms['expected_noise']:.2f} um. No name is given: {remains}.",
        )
    names = "; ".join(_named(f) for f in found.findings if f.effect)
    if found.verdict == "partly":
        return f"Missing in the model: {names}, and something else", f"{fell}. {remains}."
    if found.verdict == "class":
        narrow = "These readings narrow the cause down to a class"
        if any(finding.status == "shown" for finding in found.findings):
            narrow = "Of some of these the readings show no more than a class"
        told = "; the next measurement tells its members apart" if found.next_measurement else ""
        return f"Missing in the model: {names}", f"{fell}. {narrow}{told}."
    return f"Missing in the model: {names}", f"{fell}. No other known effect comes near."


def state_words(found: Diagnosis) -> dict[str, str]:
    """What the model holds in each state that is looked at."""
    fit = found.residuals.fit
    if fit is None:
        return {"before": "measured minus predicted"}
    return {"before": "before", "after": "with the effects found"}


def _named(finding: Finding) -> str:
    words = _words_of(finding.effect, finding.target) if finding.effect else finding.name
    return f"{words}, or an effect like it" if finding.status == "class" else words


def _words_of(effect: Effect, target: str) -> str:
    if effect.corrects_table:
        return f"the error table {target} as it is now"
    title = title_of(effect, target)
    if title != effect.title:
        return f"{title}, {target}"
    title = title.split(" (")[0]
    if target in LINEAR_AXES:
        return f"{title} in {target}"
    return f"{title}, {target}" if target else title
