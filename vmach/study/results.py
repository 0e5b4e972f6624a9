"""A folder of results: one file a case, written whole, and the table that is made of them."""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vmach import __version__
from vmach.errors import InputError
from vmach.files.csv_table import Cells, rounded, whole, words
from vmach.study.case import Case
from vmach.study.study import Study

__all__ = ["ResultFolder", "merged_columns"]

_STUDY, _CASES, _FAILED = "study.json", "cases", "failed"
#: decimals of numbers in a merged CSV; `.npz` and `.parquet` have all digits
_DECIMALS = 9


@dataclass(frozen=True)
class ResultFolder:
    """Where the results of a study lie: ``cases/KEY.json``, what failed in ``failed/KEY.txt``."""

    path: Path

    def open_for(self, study: Study) -> None:
        """Make the folder, or make sure that it is of the same study.

        Raises
        ------
        InputError
            It holds something else, or results of the study as it was.
        """
        mine = _record(study)
        place = self.path / _STUDY
        if self.path.exists() and not place.exists() and any(self.path.iterdir()):
            raise InputError(
                "the folder holds files, and no study", file=self.path,
                accepted="a new folder, or one of this study",
            )  # fmt: skip
        for name in (_CASES, _FAILED):
            (self.path / name).mkdir(parents=True, exist_ok=True)
        if place.exists():
            self._check_same(json.loads(place.read_text(encoding="utf-8")), mine)
        else:
            _write_whole(place, json.dumps(mine, indent=1) + "\n")

    def _check_same(self, theirs: Mapping[str, Any], mine: Mapping[str, Any]) -> None:
        changed = [name for name in mine if theirs.get(name) != mine[name]]
        if not changed:
            return
        what = changed[0]
        if what == "inputs":
            before = theirs.get("inputs", {})
            what = next((f for f in mine["inputs"] if before.get(f) != mine["inputs"][f]), "a file")
        raise InputError(
            f"the results in the folder are of the study before '{what}' changed",
            file=self.path,
            accepted="the study as it was, or another folder",
            hint="--out names one",
        )

    def first_failure(self) -> str:
        """The case that failed first by its name, and why; empty where none did."""
        for path in sorted((self.path / _FAILED).glob("*.txt")):
            said = path.read_text(encoding="utf-8", errors="replace").split("\n")
            rows = [row for row in said if row.strip()]
            return f"{rows[0]}: {rows[-1].strip()}" if rows else path.name
        return ""

    def is_done(self, case: Case) -> bool:
        """Whether the case has its result."""
        return self._file(case).exists()

    def done(self) -> set[str]:
        """Keys of all cases that have their results."""
        names = os.listdir(self.path / _CASES) if (self.path / _CASES).is_dir() else []
        return {name.removesuffix(".json") for name in names if name.endswith(".json")}

    def keep(self, case: Case, text: str) -> None:
        """Write a result, whole or not at all."""
        _write_whole(self._file(case), text + "\n")
        self._failure(case).unlink(missing_ok=True)

    def keep_failure(self, case: Case, text: str) -> None:
        """Write down why a case has no result; it is tried again the next time."""
        _write_whole(self._failure(case), f"{case}\n{text}\n")

    def read(self, case: Case) -> dict[str, Any]:
        """A case's record: its values in ``case``, what was found in ``result``.

        Raises
        ------
        InputError
            The file is no record of it.
        """
        path = self._file(case)
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
            if found["case"] != dict(case.values):
                raise ValueError("the record of another case")
            return found
        except (ValueError, KeyError, TypeError) as error:
            raise InputError(
                f"no result of case {case}: {error}", file=path,
                accepted="what vmach batch wrote", hint="delete it, and run the study again",
            ) from None  # fmt: skip

    def _file(self, case: Case) -> Path:
        return self.path / _CASES / f"{case.key}.json"

    def _failure(self, case: Case) -> Path:
        return self.path / _FAILED / f"{case.key}.txt"


def _record(study: Study) -> dict[str, Any]:
    """What the results depend on: another record, another study."""
    inputs = {
        os.path.relpath(path, study.folder): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in study.files()
    }
    keys = "".join(case.key for case in study.cases)
    return {
        "schema": 1,
        "vmach": __version__,
        "function": study.task.name,
        "seed": study.cases[0].seed,
        "cases": len(study.cases),
        "cases_sha256": hashlib.sha256(keys.encode()).hexdigest(),
        "inputs": inputs,
    }


def _write_whole(path: Path, text: str) -> None:
    """By a file beside it that then takes its name: others see all of it or nothing."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        beside.write_text(text, encoding="utf-8")
        os.replace(beside, path)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise


def merged_columns(cases: Sequence[Case], folder: ResultFolder) -> dict[str, Cells]:
    """One row a case in the order of the study: its values, then what was found.

    Lists become columns ``name_1``, ``name_2`` ...; what a case lacks is an empty cell.

    Raises
    ------
    InputError
        A case has no result.
    """
    missing = [case for case in cases if not folder.is_done(case)]
    if missing:
        raise InputError(
            f"{len(missing)} of {len(cases)} cases have no result, the first is {missing[0]}",
            file=folder.path, accepted="results of all cases", hint="run the study again",
        )  # fmt: skip
    rows = []
    for case in cases:
        record = folder.read(case)
        rows.append({**_flat(record["case"]), **_flat(record["result"])})
    names = dict.fromkeys(name for row in rows for name in row)
    return {"case": words([case.key for case in cases])} | {
        name: _cells([row.get(name) for row in rows]) for name in names
    }


def _flat(value: Any, name: str = "") -> dict[str, Any]:
    if isinstance(value, dict):
        parts: Iterable = value.items()
    elif isinstance(value, list):
        parts = enumerate(value, 1)
    else:
        return {name: value}
    return {
        key: found
        for part, inner in parts
        for key, found in _flat(inner, f"{name}_{part}" if name else str(part)).items()
    }


def _cells(values: list[Any]) -> Cells:
    shown = np.array([value is not None for value in values])
    known = [value for value in values if value is not None]
    if all(isinstance(value, int) and abs(value) < 2**63 for value in known):
        return whole(np.array([value or 0 for value in values]), shown=shown)
    if all(isinstance(v, int | float) and abs(v) <= sys.float_info.max for v in known):
        numbers = np.array([0.0 if value is None else value for value in values], dtype=float)
        cells = rounded(numbers, _DECIMALS)
        return Cells(cells.values, cells.written, cells.decimals, cells.is_trimmed, shown)
    return words(["" if value is None else str(value) for value in values])
