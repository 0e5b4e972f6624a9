"""Effects whose parameters the places of the readings leave open, each as well as the other."""

from __future__ import annotations

from collections.abc import Iterator

from vmach.base.note import Kind, Note
from vmach.diagnosis.fitted_parameters import alike_parameters
from vmach.diagnosis.inference.verdicts import Inference

__all__ = ["alike_waves"]

#: of those values so many are said
_MOST = 6


def alike_waves(found: Inference) -> Iterator[Note]:
    """A note on each wave that is shown, and that shorter or longer ones cannot be told from."""
    fit = found.fit
    if fit is None:
        return
    for k, term in enumerate(fit.terms[: len(found.supports)]):
        others = alike_parameters(fit, k)
        if not others:
            continue
        name = term.effect.inner_parameters[0].name
        values = sorted((other[name] for other in others), reverse=True)
        listed = ", ".join(f"{value:.3g}" for value in values[:_MOST])
        more = f" and {len(values) - _MOST} more" if len(values) > _MOST else ""
        said = (
            f"{term.label}: the places lie evenly, and {name} = {listed}{more} would read the same "
            f"as {fit.parameters(k)[name]:.3g}; measure in uneven steps, or in tenths of it"
        )
        yield Note.plain(Kind.TARGETS, said, len(values), "1", place=term.label)
