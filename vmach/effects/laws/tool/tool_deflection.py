"""Tool deflection: cutting force bends the tool away from the wall."""

from dataclasses import replace

import numpy as np

from gcode import MoveKind
from vmach.effects.effect import Effect
from vmach.effects.parameter import inner, linear

__all__ = ["ToolDeflection"]

#: share of the diameter beyond which a radial depth is no finishing cut
_SLOTTING = 0.15
#: what another program left in a slot, in one slot against the next: standard deviation
_ALLOWANCE_SPREAD_MM = 0.3
#: of the force: between edges that only rub and chips that cost nothing extra
_EXPONENTS = (0.3, 1.3)

#: from next to nothing, as where a slot was cut from the full, to four times the largest tried
_ALLOWANCES_MM = (0.0005, 3.2)


class ToolDeflection(Effect):
    """Material is left in proportion to the force across the wall and the tool's slenderness.

    The force goes with the axial depth and with powers of radial depth and feed per tooth; a
    slender tool gives way with length cubed over diameter to the fourth. The amplitudes are stated
    for a cut 10 mm deep and 1 mm wide at 0.1 mm per tooth, with a tool of 20 mm diameter, 100 mm
    long. The radial depth comes from the earlier passes of the program. Where there are none,
    walls would be made by slotting; they are taken as roughed by another program, which left
    `allowance_mm` on average. Each cut, from one rapid to the next, may have found another.
    """

    name = "tool_deflection"
    title = "deflection of the tool under the cutting force"
    commonness = 27
    shows_as = "force across the wall"
    law = (
        "(machine + (tool + taper (1/2 - h) + climb c) λ) b^width_exponent F n_xy + slot c λ F "
        "n_xy where a slot is cut from the full. F = (depth/10 mm) "
        "(feed per tooth/0.1 mm)^feed_exponent. λ = (L/100 mm)^3 (20 mm/D)^4. b is the radial "
        "depth in mm, h the share of the depth from the tip, c = ±1 in down and up milling"
    )
    source = (
        "equation (8) of docs/laws.md; cantilever L^3/(3 E I); chip thickness exponent 1 - "
        "m_c after Kienzle"
    )
    parameters = (
        linear("tool_um", "bending of the tool in the reference cut", usual=3.0, is_size=True),
        linear(
            "machine_um",
            "compliance of spindle and machine in the reference cut",
            usual=1.0,
            is_size=True,
        ),
        replace(
            linear("taper_um", "bending at the tip minus bending at the top of the cut", usual=1.0),
            at_most="tool_um",
        ),
        replace(
            linear("climb_um", "half of what down milling bends more than up milling", usual=1.0),
            at_most="tool_um",
        ),
        linear("slot_um", "bending across the way where a slot is cut from the full", usual=1.0),
        inner(
            "feed_exponent",
            "of the force with feed per tooth",
            (0.6, 0.8, 1.0),
            usual=0.8,
            spread=0.3,
            within=_EXPONENTS,
        ),
        inner(
            "width_exponent",
            "of the force with the radial depth",
            (0.8, 1.0),
            usual=0.9,
            spread=0.1,
            optional=True,
            within=_EXPONENTS,
        ),
        inner(
            "allowance_mm",
            "radial depth of walls that an earlier program roughed",
            (0.05, 0.1, 0.2, 0.4, 0.8),
            usual=0.3,
            within=_ALLOWANCES_MM,
        ),
    )
    targets = ("",)
    needs_surface = True
    slack_share = 0.15
    usual_size = "5 to 30 um in finishing, up to 100 um in roughing"
    confirm = "run a spring pass: the same path again without infeed takes off what was left"
    cure = "shorter or thicker tool, smaller allowance, lower feed per tooth, or a spring pass"
    # the mean chip thickness is f_z sqrt(a_e / D) over an arc of 2 sqrt(a_e / D): with Kienzle's
    # exponent p = 1 - m_c of the feed, the radial depth has (1 + p) / 2

    def displacement(
        self,
        path,
        target,
        tool_um,
        machine_um,
        taper_um,
        climb_um,
        slot_um,
        feed_exponent,
        width_exponent,
        allowance_mm,
    ):
        diameter, depth = path.of_tool("diameter_mm"), path.axial_depth_mm
        slotting = _is_slotted(path)
        width = np.where(slotting, allowance_mm, path.radial_depth_mm)
        force = depth / 10.0 * (path.feed_per_tooth_mm / 0.1) ** feed_exponent
        slender = (path.of_tool("length_mm") / 100.0) ** 3 * (20.0 / diameter) ** 4
        height = path.contact_mm[:, 2] / np.where(depth > 0, depth, 1.0)
        # material on the right of the way is milled down by a tool that turns clockwise
        v = path.velocity_mm_per_s
        climbing = np.sign(path.normal[:, 1] * v[:, 0] - path.normal[:, 0] * v[:, 1])
        share = tool_um + taper_um * (0.5 - height) + climb_um * climbing
        left_um = (machine_um + share * slender) * width**width_exponent * force
        left_um += slot_um * slotting * climbing * slender * force
        return 1e-3 * left_um[:, None] * path.side_normal

    def slack(self, path, target, parameters):
        in_law = super().slack(path, target, parameters)
        cut = np.cumsum(path.moves.kind == MoveKind.RAPID)[path.states.move]
        slots = np.unique(cut[_is_slotted(path)])
        spread = {**parameters, "allowance_mm": _ALLOWANCE_SPREAD_MM, "slot_um": 0.0}
        pattern = self.slack_pattern(path, target, spread)
        of_slot = pattern[:, :, None] * (cut[:, None] == slots)[:, None, :]
        return np.concatenate([in_law, of_slot], axis=2)


def _is_slotted(path) -> np.ndarray:
    """Whether the program would have cut here from the full, (P,) bool."""
    return path.radial_depth_mm > _SLOTTING * path.of_tool("diameter_mm")
