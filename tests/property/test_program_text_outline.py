"""What is planned of a program is the same whether plain lines are told in stretches or alone."""

from unittest.mock import patch

import numpy as np
import pytest

import gcode.program
from gcode import PlainLines, ProgramError, Source, ToolEntry, read_program
from gcode.fast import fast_lane
from tests.lane_programs import Dice, random_program
from vmach.program_text import block_modes
from vmach.program_text.expanding.expansion import expanded

TOOLS = {k: ToolEntry(100.0, 10.0) for k in (1, 2)}


def planned(text, language, *, fast_from):
    """Text that is written out, its lines and their modes; or the message that refuses it."""
    with patch.multiple(gcode.program, _FAST_FROM=fast_from), patch.object(fast_lane, "_SHORT", 0):
        try:
            program = read_program(Source(text), tools=TOOLS, dialect=language, max_blocks=2000)
            plain, how = expanded(program)
            modes = block_modes(plain)
        except (ProgramError, ValueError) as error:
            return str(error), 0
        told = sum(part.last - part.first + 1 for part in plain.outline
                   if isinstance(part, PlainLines))  # fmt: skip
        return (plain.source.data, how.origin.tolist(), how.reasons, dict(modes)), told


@pytest.mark.parametrize("language", ["sinumerik", "heidenhain"])
def test_lines_told_in_stretches_are_planned_as_lines_told_alone(language):
    dice, told, refused = Dice(8), [], 0
    for seed in range(150):
        text = random_program(language, dice, sound=seed % 3 > 0)
        if seed % 8:  # as `compensate` asks for them
            text = text.replace(b",", b".").replace(b"70+5", b"75").replace(b"= ", b"=")
        alone, none = planned(text, language, fast_from=10**9)
        stretches, count = planned(text, language, fast_from=0)
        assert stretches == alone
        assert none == 0
        refused += isinstance(alone, str)
        told.append(count / max(text.count(b"\n"), 1))
    assert refused < 90
    assert np.mean(told) > 0.2
