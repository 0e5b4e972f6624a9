"""One case of a study: its values, its name, its random numbers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

__all__ = ["Case", "Value"]

Value = str | float | int | bool

#: characters of a key: 64 bits tell ten thousand cases apart with odds of 3e-12 of a mistake
_KEY_LENGTH = 16


@dataclass(frozen=True)
class Case:
    """What one call of the study's function is about.

    Attributes
    ----------
    values : mapping of name to Value
    folder : Path
        Of the study; names of files count from here.
    seed : int
        Of the study.
    """

    values: Mapping[str, Value]
    folder: Path
    seed: int

    @cached_property
    def digest(self) -> bytes:
        """What the case is, whichever place it has in the study, 32 bytes."""
        text = json.dumps(dict(self.values), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).digest()

    @property
    def key(self) -> str:
        """The case's name among the results."""
        return self.digest.hex()[:_KEY_LENGTH]

    @property
    def entropy(self) -> tuple[int, ...]:
        """What its random numbers begin from: the study's seed and what the case is."""
        return (self.seed, *np.frombuffer(self.digest, dtype="<u4").tolist())

    def random(self) -> np.random.Generator:
        """The case's own random numbers (Philox, counter-based), whoever works on it and when."""
        return np.random.Generator(np.random.Philox(np.random.SeedSequence(self.entropy)))

    def file(self, name: str) -> Path:
        """A file that a value names."""
        return self.folder / str(self.values[name])

    def __str__(self) -> str:
        told = ", ".join(f"{name} = {value}" for name, value in self.values.items())
        return f"{self.key} ({told})"
