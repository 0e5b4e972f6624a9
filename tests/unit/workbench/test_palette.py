"""Colours that say something are told apart by people who see fewer of them; text is readable.

Sources: G. Machado, M. Oliveira, L. Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, and
the distance in CAM02-UCS, both as `colorspacious` has them; contrast as in WCAG 2.1, 1.4.3.
"""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

import vmach.workbench
from vmach.base.colour_ramp import COLOUR_STOPS

colours = pytest.importorskip("colorspacious")

STYLE = (Path(vmach.workbench.__file__).parent / "static" / "bench.css").read_text()
SIGHTS = {"deuteranopia": "deuteranomaly", "protanopia": "protanomaly"}
#: colours that stand for different things side by side
APART = [("gone", "left"), ("before", "after"), ("left", "accent"), ("left", "good"),
         ("accent", "good"), ("left", "soft"), ("accent", "soft"), ("good", "soft"),
         ("bad", "ink"), ("bad", "good"), ("warn", "good"), ("warn", "accent")]  # fmt: skip
TEXTS = [("ink", "paper"), ("ink", "card"), ("ink", "field"), ("ink", "mark"), ("soft", "paper"),
         ("soft", "card"), ("accent", "paper"), ("accent", "card"), ("on-accent", "accent"),
         ("bad", "bad-card"), ("bad", "paper"), ("warn", "warn-card")]  # fmt: skip
#: of the distance, in which 1 is just seen
CLEARLY = 10.0


def rgb(hexadecimal):
    return np.array([int(hexadecimal[i : i + 2], 16) for i in (1, 3, 5)]) / 255


def theme(number):
    """The colours of the light (0) or the dark (1) page."""
    block = re.findall(r":root \{(.*?)\}", STYLE, re.DOTALL)[number]
    return {name: rgb(value) for name, value in re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block)}


def seen(colour, sight):
    space = {"name": "sRGB1+CVD", "cvd_type": SIGHTS[sight], "severity": 100}
    return np.clip(colours.cspace_convert(colour, space, "sRGB1"), 0, 1)


def distance(first, second, sight):
    a, b = seen(first, sight), seen(second, sight)
    return float(colours.deltaE(a, b, input_space="sRGB1"))


@pytest.mark.parametrize("sight", SIGHTS)
def test_material_left_is_never_taken_for_material_gone(sight):
    stops = [rgb(stop) for stop in COLOUR_STOPS]
    for k in range(len(stops) // 2):
        assert distance(stops[k], stops[-1 - k], sight) > 2.5 * CLEARLY
    for one, next_one in itertools.pairwise(stops):
        assert distance(one, next_one, sight) > CLEARLY


@pytest.mark.parametrize("sight", SIGHTS)
@pytest.mark.parametrize("number", [0, 1], ids=["light", "dark"])
@pytest.mark.parametrize("pair", APART, ids="-".join)
def test_colours_that_mean_something_are_told_apart(pair, number, sight):
    of = theme(number)
    assert distance(of[pair[0]], of[pair[1]], sight) > CLEARLY


def luminance(colour):
    linear = np.where(colour <= 0.03928, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


@pytest.mark.parametrize("number", [0, 1], ids=["light", "dark"])
@pytest.mark.parametrize("pair", TEXTS, ids="-on-".join)
def test_text_is_readable(pair, number):
    of = theme(number)
    high, low = sorted((luminance(of[name]) for name in pair), reverse=True)
    assert (high + 0.05) / (low + 0.05) >= 4.5
