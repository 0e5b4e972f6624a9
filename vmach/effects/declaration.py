"""What the class of an effect has to say of itself, checked before anything asks for it.

What is missing, unknown or misspelt is an error with the line in the file that says it.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Iterable
from numbers import Real
from pathlib import Path

from vmach.effects.effect import Effect
from vmach.effects.parameter import Parameter
from vmach.files.declaration import Declaration

__all__ = ["check_declaration", "has_unit", "unit_of"]

#: units that end the names of parameters, perhaps followed by what they are counted per
_UNIT = re.compile(
    r"(?:^|_)(?:nm|um|mm|m|urad|mrad|rad|deg|ppm|percent|share|exponent|ms2|ms|s|min|h|K|degC|N|W|kg|"
    r"rpm|Hz)(?:_per_\w+)?$"
)

#: attributes that say yes or no; words; numbers
_YES_OR_NO = (
    "needs_surface",
    "corrects_table",
    "turns_tool",
    "is_sudden",
    "is_never_exact",
    "imitates_as_team",
    "goes_before_curves",
    "follows_travel",
)
_WORDS = ("shows_as", "law", "usual_size", "confirm", "cure", "source", "signature")
#: what the pages of the package's own effects are made of
_PRINTED = ("shows_as", "law", "usual_size", "confirm", "cure")
_NUMBERS = ("commonness", "rarity", "slack_share", "slack_time_s")
#: how a source names its equation: "equation (3) of ..."
_EQUATION = re.compile(r"equation \(\d+\) of \S")


def check_declaration(
    kind: type[Effect], file: Path | None = None, *, is_printed: bool = False
) -> None:
    """Refuse a class that does not say what an effect has to say.

    Parameters
    ----------
    kind : subclass of Effect
    file : Path, optional
        Where it stands; needed where it is in no module that Python knows.
    is_printed : bool
        Whether it stands in the catalogue's pages: its law, where that comes from, with the number
        of the equation, and what a machinist is told.

    Raises
    ------
    InputError
        With the file and the line of what is missing, unknown or wrong.
    """
    declaration = _OfEffect(kind, Effect, "effect", file)
    declaration.check()
    if not is_printed:
        return
    declaration.check_words(_PRINTED)
    if not _EQUATION.match(kind.source):
        raise declaration.error(
            f"source = {kind.source!r}",
            key="source",
            accepted="equation (NUMBER) of PAGE; and where the law comes from",
        )


class _OfEffect(Declaration):
    """What the class of an effect says."""

    def check(self) -> None:
        self.check_known()
        self.check_name()
        self.check_words(["title"])
        self._check_types(_YES_OR_NO, bool, "True or False")
        self._check_types(_WORDS, str, "text in quotes")
        self._check_types(_NUMBERS, Real, "a number, 0 or more")
        self._check_targets()
        self._check_parameters()
        self._check_law()

    def _check_types(self, names: Iterable[str], kind: type, accepted: str) -> None:
        for name in names:
            value = getattr(self.kind, name)
            if not isinstance(value, kind) or (kind is Real and not 0.0 <= value < math.inf):
                raise self.error(f"{name} = {value!r}", key=name, accepted=accepted)

    def _check_targets(self) -> None:
        targets = self.kind.targets
        if targets == () and self.kind.possible_targets is not Effect.possible_targets:
            return
        if isinstance(targets, tuple) and targets and all(map(_is_target, targets)):
            return
        raise self.error(
            f"targets = {targets!r}",
            key="targets",
            accepted='a tuple of words such as ("X", "Y"), or ("",) where there is no choice',
            hint=f'a comma after it: targets = ("{targets}",)'
            if isinstance(targets, str)
            else None,
        )

    def _check_parameters(self) -> None:
        parameters = self.given("parameters", "a tuple of linear(...) and inner(...)")
        accepted = "a tuple of linear(...) and inner(...)"
        if isinstance(parameters, Parameter):
            hint = "a comma after it: parameters = (linear(...),)"
            raise self.error(
                f"parameters = {parameters.name} alone", key="parameters", accepted=accepted,
                hint=hint,
            )  # fmt: skip
        good = isinstance(parameters, tuple) and all(isinstance(p, Parameter) for p in parameters)
        if not good or not parameters:
            raise self.error(f"parameters = {parameters!r}", key="parameters", accepted=accepted)
        names = [p.name for p in parameters]
        if twice := [n for n in names if names.count(n) > 1]:
            what = f"two parameters are called {twice[0]}"
            raise self.error(what, key="parameters", accepted="every name once")
        for parameter in parameters:
            self._check_parameter(parameter)
        if self.kind.columns is Effect.columns and not any(p.is_linear for p in parameters):
            what = f"no amplitude among {', '.join(names)}"
            raise self.error(what, key="parameters", accepted="at least one linear(...)")

    def _check_parameter(self, p: Parameter) -> None:
        wrong = {
            f"is called {p.name!r}": not (isinstance(p.name, str) and p.name.isidentifier()),
            f"is accepted from {p.low!r} to {p.high!r}": not p.low < p.high,
            f"is usually {p.usual!r}": not (0.0 < p.usual <= p.high and math.isfinite(p.usual)),
            f"starts from {p.grid!r}": not all(p.low <= value <= p.high for value in p.grid),
        }
        for what, is_wrong in wrong.items():
            if is_wrong:
                raise self.error(
                    f"parameter {p.name} {what}",
                    key="parameters",
                    accepted="a name with its unit at the end, low below high, a usual size above "
                    "0 and starting values within the bounds",
                )

    def _check_law(self) -> None:
        names = [p.name for p in self.kind.parameters]
        call = f"def displacement(self, path, target, {', '.join(names)})"
        if inspect.isabstract(self.kind):
            raise self.error("displacement() is missing", accepted=call)
        if not inspect.isroutine(self.kind.displacement):
            raise self.error("displacement is no function", key="displacement", accepted=call)
        signature = inspect.signature(self.kind.displacement)
        try:
            signature.bind(None, None, "", **dict.fromkeys(names, 0.0))
        except TypeError as error:
            raise self.error(
                f"displacement{signature} does not fit its parameters: {error}",
                key="displacement",
                accepted=call,
            ) from None


def has_unit(name: str) -> bool:
    """Whether the name of a parameter ends in a unit: ``rise_um_per_m``."""
    return _UNIT.search(name) is not None


def unit_of(name: str) -> str:
    """The unit at the end of a parameter's name; empty where there is none."""
    found = _UNIT.search(name)
    return "" if found is None else found[0].removeprefix("_")


def _is_target(target: object) -> bool:
    return isinstance(target, str) and not re.search(r"\s", target)
