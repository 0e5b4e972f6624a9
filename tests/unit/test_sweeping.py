"""Sweeps follow the displacement at the nodes, and interpolate smoothly in between."""

from dataclasses import fields

import numpy as np
import pytest

from gcode import MoveKind
from tests.unit.test_path_geometry import HELIX, LINE, make_moves
from vmach.machine import RigidDisplacement
from vmach.path.toolpath import Toolpath
from vmach.prediction.sweeping import build_sweeps, join_sweeps

ZERO_MM = np.array([3.0, -2.0, -200.0])


def sweeps_of(moves, field):
    """Sweeps of a path displaced by ``field(nose)``, and the path."""
    path = Toolpath.split(moves, np.array([np.nan, 120.0]))
    shift = field(path.nodes.nose_mm)
    displaced = RigidDisplacement(shift, np.zeros_like(shift))
    return build_sweeps(path, displaced, zero_mm=ZERO_MM, tool_index=np.array([-1, 0])), path


def wave(nose):
    """10 um at 50 mm wave length along X and Y."""
    return 0.01 * np.sin(2 * np.pi * nose[:, [1, 0, 0]] / 50)


def test_tip_is_the_nose_less_tool_and_zero():
    sweeps, _ = sweeps_of(make_moves(LINE), wave)
    assert sweeps.start_mm[0] == pytest.approx([-3, 2, 80])
    assert sweeps.end_mm[-1] == pytest.approx([27, 42, 80])


@pytest.mark.parametrize("move", [LINE, HELIX])
def test_interpolation_between_nodes_is_cubic(move):
    sweeps, path = sweeps_of(make_moves(move), wave)
    inner = np.arange(1, len(sweeps) - 1)  # the ends of a move are a parabola
    s = np.full(len(inner), 0.5)
    states = path.states_on_pieces(inner, s, contact_mm=np.zeros((len(inner), 3)))
    shift, tilt = sweeps.displacement_at(inner, s)
    # h^4/384 f'''' of the Hermite form plus h^3/24 f''' of its slopes: 0.04 um here
    assert np.abs(shift - wave(states.nose_mm)).max() < 6e-5
    assert not tilt.any()


def test_parabola_is_met_exactly_even_in_the_first_piece():
    sweeps, path = sweeps_of(make_moves(LINE), lambda nose: 1e-6 * nose**2)
    s = np.linspace(0, 1, len(sweeps))
    piece = np.arange(len(sweeps))
    nose = path.states_on_pieces(piece, s, contact_mm=np.zeros((len(s), 3))).nose_mm
    shift, _ = sweeps.displacement_at(piece, s)
    assert shift == pytest.approx(1e-6 * nose**2, abs=1e-15)


def test_a_jump_between_moves_is_not_smeared():
    back = {"kind": MoveKind.LINE, "start_mm": (30, 40, 0), "end_mm": (0, 0, 0)}
    moves = make_moves(LINE, back)
    path = Toolpath.split(moves, np.array([np.nan, 120.0]))
    shift = 0.003 * path.nodes.direction
    displaced = RigidDisplacement(shift, np.zeros_like(shift))
    sweeps = build_sweeps(path, displaced, zero_mm=ZERO_MM, tool_index=np.array([-1, 0]))
    assert not sweeps.shift_slope_mm.any()
    assert np.unique(sweeps.shift_mm[:10, :, 0]).tolist() == [0.003]
    assert np.unique(sweeps.shift_mm[10:, :, 0]).tolist() == [-0.003]


def test_single_piece_is_linear():
    short = LINE | {"end_mm": (3, 0, 0)}
    sweeps, _ = sweeps_of(make_moves(short), wave)
    rise = sweeps.shift_mm[:, 1] - sweeps.shift_mm[:, 0]
    assert sweeps.shift_slope_mm[:, 0] == pytest.approx(rise)
    assert sweeps.shift_slope_mm[:, 1] == pytest.approx(rise)


def test_a_path_in_parts_gives_the_same_sweeps():
    """Parts end where moves do, so slopes at their ends need no neighbour."""
    back = {"kind": MoveKind.LINE, "start_mm": (30, 40, 0), "end_mm": (0, 0, 0)}
    whole, path = sweeps_of(make_moves(*[LINE, back] * 6), wave)
    assert len(path.first_node) > 100
    for count in (1, 15, 10**6):
        parts = list(path.parts(count))
        assert len(parts) == {1: 12, 15: 6, 10**6: 1}[count]
        joined = join_sweeps(
            parts,
            lambda nodes: RigidDisplacement(wave(nodes.nose_mm), np.zeros_like(nodes.nose_mm)),
            count=len(path.first_node),
            zero_mm=ZERO_MM,
            tool_index=np.array([-1, 0]),
        )
        for field in fields(whole):
            assert np.array_equal(getattr(joined, field.name), getattr(whole, field.name))


def test_the_moves_of_some_pieces_give_the_same_sweeps():
    back = {"kind": MoveKind.LINE, "start_mm": (30, 40, 0), "end_mm": (0, 0, 0)}
    whole, path = sweeps_of(make_moves(*[LINE, back] * 6), wave)
    piece = np.array([57, 3, 4, 110, 57])
    some, here = path.of_pieces(piece)
    assert len(some.first_node) < len(path.first_node) / 2
    moved = wave(some.nodes.nose_mm)
    found = build_sweeps(
        some,
        RigidDisplacement(moved, np.zeros_like(moved)),
        zero_mm=ZERO_MM,
        tool_index=np.array([-1, 0]),
    )
    for field in fields(whole):
        assert np.array_equal(getattr(found, field.name)[here], getattr(whole, field.name)[piece])
