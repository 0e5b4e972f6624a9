"""Compiled code reads SINUMERIK, Klartext and DIN/ISO as the interpreter does, to the bit."""

from dataclasses import fields
from unittest.mock import patch

import numpy as np
import pytest

from gcode import ControlSettings, ProgramError, Source, ToolEntry, read_program
from gcode.dialects.heidenhain.confirmed import CONFIRMED as OF_KLARTEXT
from gcode.dialects.sinumerik.confirmed import CONFIRMED as OF_SINUMERIK
from gcode.fast import fast_lane
from gcode.language.confirmation import unconfirmed_words
from gcode.language.translated_lane import TranslatedLane
from tests.lane_programs import LANGUAGES, Dice, random_program

TOOLS = {n: ToolEntry(10.0 * n, 2.0 * n) for n in range(1, 6)}
PLAIN = "\n".join(f"G1 X{k}" for k in range(20)) + "\n"


def bits(table):
    values = {f.name: getattr(table, f.name) for f in fields(table)}
    return {n: v.tobytes() if isinstance(v, np.ndarray) else repr(v) for n, v in values.items()}


def outcome(text, **options):
    """All that a program gives, as bytes and texts, or the message that it gives."""
    try:
        program = read_program(Source(text), tools=TOOLS, **options)
        moves = bits(program.moves)
    except ProgramError as error:
        return str(error)
    record = program.record
    return (program.notes, list(map(str, record.events)), record.arcs.tobytes(),
            record.dwells.tobytes(), bits(record.path()), moves)  # fmt: skip


def assert_read_alike(text, **options):
    slow = outcome(text, fast=False, **options)
    assert outcome(text, fast=True, **options) == slow
    with patch.object(fast_lane, "_SHORT", 0):  # even single lines go to the compiled reader
        assert outcome(text, fast=True, **options) == slow
    return slow


@pytest.mark.parametrize("language", LANGUAGES)
def test_random_programs_give_the_same_bits(language):
    dice, lines, taken, read, skip = Dice(2), 0, [], 0, TranslatedLane.skip

    def counted(lane):
        before = lane.reader.next
        done = skip(lane)
        taken.append(lane.reader.next - before)
        return done

    with patch.object(TranslatedLane, "skip", counted):
        for _ in range(200):
            text = random_program(language, dice)
            ignored = dice.choice([(), (), (), (3,)])
            control = ControlSettings(ignore_m=ignored, block_delete=dice.random() < 0.5)
            found = assert_read_alike(
                text, dialect=language, control=control, max_blocks=2000,
                machine_unit_mm=dice.choice([1.0, 1.0, 25.4]),
                work_offsets_mm={"G55": (10.5, -3.25, 7.1)})  # fmt: skip
            lines, read = lines + text.count(b"\n"), read + (not isinstance(found, str))
    assert read > 80
    assert sum(taken) > 0.3 * lines


@pytest.mark.parametrize("most", [20, 50, 100, 500, 3000])
@pytest.mark.parametrize(
    ("language", "text"),
    [
        ("sinumerik", f"F100\nLAB:\n{PLAIN}REPEAT LAB P=90\nM30\n"),
        ("sinumerik", f"F100\nR1=0\nWHILE R1<5\n{PLAIN}R1=R1+1\nENDWHILE\nM30\n"),
        ("sinumerik", f"F100\nWHILE R1<5\n{PLAIN}ENDWHILE\nM30\n"),
        ("sinumerik", f"F100\nUP1\nG505\n{PLAIN}M30\n%_N_UP1_SPF\n{PLAIN}M17\n"),
        ("heidenhain", f"L F100\nLBL 1\n{PLAIN}CALL LBL 1 REP 90\nL M30\n".replace("G1", "L")),
        ("heidenhain", f"L F9\nLBL 1\n{PLAIN}FN 9: IF +0 EQU +0 GOTO LBL 1\n".replace("G1", "L")),
        ("tnciso", f"%A G71\nG01 F100\nG98 L1\n{PLAIN}L1,90\nN9 %A G71\n"),
    ],
)
def test_blocks_count_in_loops(language, text, most):
    assert_read_alike(text.encode(), dialect=language, max_blocks=most)


def test_what_compiled_code_takes_needs_no_note():
    # it does not count the words that are used: all of them have to be confirmed
    letters = ["G0", "G1", "G2", "G3", "G90", "G91", "CR", *(f"M{k}" for k in (3, 4, 5, 7, 8, 9))]
    assert unconfirmed_words(letters, OF_SINUMERIK) == []
    words = ["L", "C", "CR", "CC", "R0", *(f"M{k}" for k in (3, 4, 5, 7, 8, 9, 13, 14))]
    assert unconfirmed_words(words, OF_KLARTEXT) == []


def test_a_letter_whose_upper_case_is_beyond_latin_1_is_read_on():
    text = b"%A G71\nG01 X+1 F100\nX+2\nN5 %B\xff G71\nX+3\n"
    assert not isinstance(assert_read_alike(text, dialect="tnciso"), str)
