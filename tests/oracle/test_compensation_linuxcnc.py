"""Compensated programs as LinuxCNC's interpreter reads them, all features of the golden programs.

Skipped where LinuxCNC is not installed. `test_compensation_corpus` does it for any folder.
"""

from pathlib import Path

import pytest

from tests.oracle.compensation_corpus import judged
from tests.oracle.linuxcnc_interpreter import is_installed

FOLDER = Path(__file__).parents[1] / "golden" / "gcode"
#: what cannot be compensated, by the reason that is given
REFUSED = {
    "cycle_spindle": "boring",
    "expressions": "turns to",
    "lathe_diameter": "diameter mode",
    "modal_state_m70": "M73 cannot be written out together with loops",
    "probing": "probing",
    "splines": "spline",
    "threading": "threading",
}
#: zeros that are set where the tool stands, called off, called back, and left for others
ZEROS = """G21 G17 G90 G94
G54
T1 M6
S3000 M3
G0 X0. Y0. Z5.
G1 Z-1. F200
X140. Y130.
G92 X0. Y0.
G1 X20.
G2 X40. Y0. I10. J0.
G91 X5. Y5. G1
G90 X60. Y20.
G92.1
G1 X100. Y50.
G10 L20 P1 X3. Z0.
G1 X30. Y40. Z-.5
Y60.
G92 Y7.
G92.2
X0.
G92.3
X5. Y5.
G52 X1. Y1.
X10.
G10 L2 P2 X4. R30.
G55
X0. Y0. Z0.
G92 X2.
X8. Y9.
G54
X3. Y4. Z0.
G0 Z10.
M30
"""
PROGRAMS = sorted(p.stem for p in FOLDER.glob("*.canon"))

pytestmark = pytest.mark.skipif(not is_installed(), reason="LinuxCNC is not installed")


@pytest.mark.parametrize("name", PROGRAMS)
def test_accepted_with_the_intended_path(name, tmp_path):
    outcome = judged(tmp_path, FOLDER / f"{name}.ngc")
    if outcome.refusal:
        assert REFUSED.get(name, "turns to") in outcome.refusal
        return
    assert name not in REFUSED
    assert outcome.linuxcnc is None
    assert outcome.wrong == []
    assert outcome.path.worst_ratio <= 1.0


def test_zeros_set_where_a_corrected_tool_stands(tmp_path):
    program = tmp_path / "zeros.ngc"
    program.write_text(ZEROS)
    outcome = judged(tmp_path / "job", program)
    assert outcome.refusal is None
    assert outcome.linuxcnc is None
    assert outcome.wrong == []
    assert max(outcome.path.ends_mm) > 2e-4, "rounding is felt"
