"""Scatter of readings that say no uncertainty: plain ones, and those that a CMM has filtered.

The filter is written here after ISO 16610-21, so that the truth is known.
"""

import numpy as np
import pytest

from vmach.measurements.neighbours import scatter_of_neighbours, unfiltered_scatter

STEP_MM, COUNT = 0.4, 6000
LINE = np.repeat([f"line {k}" for k in range(12)], COUNT // 12)


def gaussian_filter(value: np.ndarray, cut_off_mm: float) -> np.ndarray:
    """ISO 16610-21: weights exp(-pi (x / (0.4697 lc))^2)."""
    x = np.arange(-cut_off_mm, cut_off_mm + 1e-9, STEP_MM)
    weight = np.exp(-np.pi * (x / (0.4697 * cut_off_mm)) ** 2)
    return np.convolve(value, weight / weight.sum(), "same")


@pytest.mark.parametrize("cut_off_mm", [0.8, 2.5, 8.0])
def test_scatter_of_a_filtered_scan_is_what_the_filter_left(cut_off_mm):
    filtered = gaussian_filter(np.random.default_rng(3).normal(0.0, 1.0, COUNT), cut_off_mm)
    found = unfiltered_scatter(filtered, LINE)
    assert found == pytest.approx(np.std(filtered), rel=0.15)


def test_neighbours_of_a_filtered_scan_scatter_by_far_too_little():
    filtered = gaussian_filter(np.random.default_rng(3).normal(0.0, 1.0, COUNT), 2.5)
    assert scatter_of_neighbours(filtered, LINE) < 0.4 * np.std(filtered)


def test_white_noise_counts_by_its_neighbours():
    white = np.random.default_rng(4).normal(0.0, 2.0, COUNT)
    assert unfiltered_scatter(white, LINE) == scatter_of_neighbours(white, LINE)


@pytest.mark.parametrize("length_mm", [60.0, 1000.0])
def test_a_form_of_the_surface_is_no_scatter(length_mm):
    place = STEP_MM * np.arange(COUNT)
    form = 20.0 * np.sin(2.0 * np.pi * place / length_mm)
    noisy = form + np.random.default_rng(5).normal(0.0, 0.5, COUNT)
    assert unfiltered_scatter(noisy, LINE) == pytest.approx(0.5, rel=0.1)


def test_few_readings_count_by_their_neighbours():
    few = np.cumsum(np.random.default_rng(6).normal(size=30))
    group = np.repeat(["a", "b"], 15)
    assert unfiltered_scatter(few, group) == scatter_of_neighbours(few, group)


def test_groups_of_two_have_the_scatter_of_all():
    value = np.array([1.0, 2.0, 3.0, 4.0])
    assert scatter_of_neighbours(value, np.array(["a", "a", "b", "b"])) == np.std(value)
