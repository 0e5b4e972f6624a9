"""Instruments are found by folder and by entry point, and say what they have to when found."""

import sys
from importlib import import_module, invalidate_caches
from pathlib import Path

import pytest

from vmach.errors import InputError
from vmach.instruments import Instrument, catalogue
from vmach.instruments.declaration import check_declaration

KINDS = Path(import_module("vmach.instruments.kinds").__file__).parent

SOUND = '''\
"""An indicator."""

from typing import ClassVar

from vmach.instruments import Instrument


class Indicator(Instrument):
    """Reads along one axis."""

    name = "indicator"
    title = "Indicator"
    columns = ("run", "position_mm", "t_s", "reading_um")
    readings = ("reading_um",)
    sign_meaning = "reading_um is positive towards +"
    left_free = "zero"

    axis: str

    def read(self, table, model):
        raise NotImplementedError
'''


@pytest.fixture
def fresh():
    module = import_module("vmach.instruments.catalogue")
    module.catalogue.cache_clear()
    yield module
    module.catalogue.cache_clear()


def test_every_file_of_the_folder_is_an_instrument():
    files = {path.stem for path in KINDS.glob("*.py")} - {"__init__"}
    assert {kind.__module__.rsplit(".", 1)[-1] for kind in catalogue().values()} == files
    assert "laser" in catalogue() and issubclass(catalogue()["laser"], Instrument)


def test_nobody_outside_the_folder_names_an_instrument():
    """Outside their files no kind stands in quotes; what is asked is the class."""
    wrong = []
    for path in KINDS.parents[1].rglob("*.py"):
        if path.parent == KINDS:
            continue
        text = path.read_text(encoding="utf-8")
        wrong += [
            f"{path.name}: kind == '{name}'"
            for name in catalogue()
            if f'kind == "{name}"' in text
            or f'kind="{name}"' in text
            or f'"kind": "{name}"' in text
        ]
    assert not wrong


def plug_in(folder, monkeypatch, *changes):
    text = SOUND
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    about = folder / "shop_indicator-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: shop-indicator\nVersion: 1.0\n")
    points = "[vmach.instruments]\nindicator = shop_indicator:Indicator\n"
    (about / "entry_points.txt").write_text(points)
    (folder / "shop_indicator.py").write_text(text)
    monkeypatch.syspath_prepend(folder)
    monkeypatch.delitem(sys.modules, "shop_indicator", raising=False)
    invalidate_caches()


@pytest.mark.usefixtures("fresh")
def test_a_package_may_offer_an_instrument(tmp_path, monkeypatch):
    plug_in(tmp_path, monkeypatch)
    assert catalogue()["indicator"].title == "Indicator"


@pytest.mark.usefixtures("fresh")
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('    title = "Indicator"\n', ""), r"indicator\.py:8: .*: 'title' is missing"),
        (("    title =", "    titel ="), r"cannot be loaded: .*titel"),
        (("left_free =", "_left_free ="), r"indicator\.py:8: .*: 'left_free' is missing"),
        (('("reading_um",)', '("reading_um")'), r"indicator\.py:14: "),
        (('"t_s", ', ""), r"indicator\.py:13: .* hold no times; accepted: t_s among them"),
        (('readings = ("reading_um",)', 'readings = ("reding_um",)'), r"py:14: .*reding_um"),
        (("axis: str", "shows_low_band = True"), r"cannot be loaded: .*shows_low_band"),
        (
            ("    axis: str", "    shows_low_band: ClassVar[bool] = True"),
            r"py:18: .*unknown attribute 'shows_low_band'; .*did you mean 'shows_law_band'",
        ),
        (("def read(", "def raed("), r"indicator\.py:20: .*did you mean 'read'"),
        (('name = "indicator"', 'name = "laser"'), r"name = 'laser' is that of vmach\.instrum"),
        (('name = "indicator"', 'name = "My laser"'), r"indicator\.py:11: .*name = 'My laser'"),
        (
            ("class Indicator(Instrument)", "class Indicator"),
            "is <class 'shop_indicator.Indicator'",
        ),
    ],
)
def test_what_is_missing_unknown_or_misspelt_is_told_with_its_line(
    tmp_path, monkeypatch, change, message
):
    plug_in(tmp_path, monkeypatch, change)
    with pytest.raises(InputError, match=message):
        catalogue()


def test_every_instrument_says_what_it_has_to():
    for kind in catalogue().values():
        check_declaration(kind)
