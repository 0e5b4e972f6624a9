"""Signatures of many forms at once: products of a few states into a few directions."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import TypeVar

import numpy as np

from vmach.diagnosis.proposals.form import USUAL_UM, Form
from vmach.diagnosis.proposals.states import Direction, State

__all__ = ["Rows", "form_rows"]

#: some of the readings: all, or their numbers
Rows = slice | np.ndarray
_Key = TypeVar("_Key", bound=Hashable)


def form_rows(
    forms: Sequence[Form],
    states: Mapping[State, np.ndarray],
    sensed: Mapping[Direction, np.ndarray],
    rows: Rows = slice(None),
) -> np.ndarray:
    """Signatures of a usual amount each over n of the readings, (M, K, n) mm.

    Parameters
    ----------
    forms : sequence of Form
        M with equally many directions, and numbers of their first and second states, each.
    states : mapping of State to (N, C) float64
        Values at all readings.
    sensed : mapping of Direction to (N, D) float64
        How these sense a unit displacement.
    rows : slice or (n,) int
    """
    push, of_push = _stacked(sensed, [form.direction for form in forms], rows)
    first, of_first = _stacked(states, [form.first for form in forms], rows)
    second, of_second = _stacked(states, [form.second for form in forms], rows)
    product = first[of_first][:, None, :, None] * second[of_second][:, None, None]
    found = push[of_push][:, :, None, None] * product
    found *= 1e-3 * USUAL_UM
    return found.reshape(len(forms), -1, found.shape[-1])


def _stacked(
    values: Mapping[_Key, np.ndarray], asked: Sequence[_Key], rows: Rows
) -> tuple[np.ndarray, np.ndarray]:
    """Values of what is asked, each once, (S, C, n), and which each is of these, (M,)."""
    # the same objects again and again: by identity, as their equality takes long to tell
    listed = {id(key): key for key in asked}
    number = {key: k for k, key in enumerate(listed)}
    stack = np.stack([values[key][rows].T for key in listed.values()])
    return stack, np.array([number[id(key)] for key in asked])
