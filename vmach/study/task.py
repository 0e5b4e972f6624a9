"""What is done with every case: a Python function, by its name."""

from __future__ import annotations

import importlib
import json
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from stock.threads import on_one_core
from vmach.errors import InputError
from vmach.study.case import Case

__all__ = ["PREDICT", "Task"]

#: what a study does that names no function: it predicts points
PREDICT = "vmach.study.predicted_case:predicted_case"
_ACCEPTED = "'module:function'; the module lies beside the study file or is installed"


@dataclass(frozen=True)
class Task:
    """The function of a study.

    Attributes
    ----------
    name : str
        ``module:function``. It is called with a `Case` and a random generator, and gives a
        mapping of names to numbers, text, and lists of these.
    folder : Path
        Where its module may lie.
    """

    name: str
    folder: Path

    def check(self) -> Callable[..., None] | None:
        """Whether there is such a function; gives what checks the values of the cases.

        Raises
        ------
        InputError
        """
        return getattr(self._function(), "check_values", None)

    def _function(self) -> Callable[[Case, np.random.Generator], Any]:
        module, _, name = self.name.partition(":")
        if not module or not name.isidentifier():
            raise InputError(f"function = {self.name!r}", accepted=_ACCEPTED)
        if str(self.folder) not in sys.path:
            sys.path.insert(0, str(self.folder))
        try:
            found = getattr(importlib.import_module(module), name, None)
        except ImportError as error:
            raise InputError(f"function = {self.name!r}: {error}", accepted=_ACCEPTED) from None
        except (Exception, SystemExit) as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            raise InputError(
                f"function = {self.name!r}: {type(error).__name__} in "
                f"{Path(place.filename).name}:{place.lineno}: {error}",
                accepted="a module that can be loaded",
            ) from error
        if not callable(found):
            raise InputError(
                f"function = {self.name!r}: module '{module}' has no function '{name}'",
                accepted=_ACCEPTED,
            )
        return found

    def result_text(self, case: Case) -> str:
        """The case's result as JSON, with one thread, so that it is the same anywhere.

        Raises
        ------
        InputError
            What the function gives is no result. Errors of the function itself go through.
        """
        function = self._function()
        with threadpool_limits(1), on_one_core():
            found = function(case, case.random())
        if not isinstance(found, dict):
            raise InputError(
                f"{self.name} gives {type(found).__name__}", accepted="a dict of numbers and text"
            )
        try:
            _check_sizes(found)
            return json.dumps(
                {"case": dict(case.values), "result": found},
                allow_nan=False, default=_plain,
            )  # fmt: skip
        except (TypeError, ValueError) as error:
            raise InputError(
                f"the result of {self.name} cannot be written: {error}",
                accepted="finite numbers, text, None, and lists or dicts of these",
            ) from None


def _check_sizes(value: Any) -> None:
    """Refuse whole numbers that no table can hold."""
    if isinstance(value, dict | list | tuple):
        for part in value.values() if isinstance(value, dict) else value:
            _check_sizes(part)
    elif isinstance(value, int) and abs(value) > sys.float_info.max:
        raise ValueError("a whole number beyond 1.8e308")


def _plain(value: Any) -> Any:
    """What JSON takes in place of NumPy's numbers and arrays."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"a {type(value).__name__}")
