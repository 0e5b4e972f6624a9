"""Where calls and jumps lead: as a look at every line finds it, and without one for each call."""

from types import SimpleNamespace

import numpy as np
import pytest

from gcode import Source, read_program
from gcode.dialects.fanuc.macro import line_places
from gcode.dialects.fanuc.macro.line_places import LinePlaces
from gcode.dialects.fanuc.macro.line_text import BLANKS, HEAD, PROGRAM, content_of
from gcode.dialects.heidenhain import reader as heidenhain
from gcode.dialects.sinumerik import reader as sinumerik
from gcode.dialects.sinumerik import text_places
from gcode.dialects.sinumerik.text_places import TextPlaces

LINES = ("O1", "N10 G1 X1", "O2 (SECOND)", "/N20 X2", ":3", "N10", "X1 (O5)", "%O7", "N030 Y1",
         "o<name>", "N20 O8", "", "/2 N40 O2", "N" + 30 * "9" + " X1")  # fmt: skip


def random_text(seed, choice=LINES, lines=40):
    rng = np.random.default_rng(seed)
    return [choice[k] for k in rng.integers(len(choice), size=lines)]


def block_by_every_line(lines, wanted, here, start, stop):
    for index in (*range(here, stop), *range(start, here)):
        number = HEAD.match(lines[index].translate(BLANKS).lower())[1]
        if number is not None and int(number) == wanted:
            return index
    return None


def bounds_by_every_line(lines, line):
    heads = [k for k, text in enumerate(lines) if PROGRAM.match(content_of(text))]
    start = max((k for k in heads if k <= line), default=0)
    after = [k for k in heads if k >= start]
    return start, after[1] if len(after) > 1 else len(lines)


@pytest.mark.parametrize("seed", range(20))
def test_programs_and_block_numbers_are_those_of_a_search_through_all_lines(seed):
    reader = SimpleNamespace(lines=random_text(seed, lines=25))
    places = LinePlaces(reader)
    for more in ([], random_text(seed + 100, lines=15)):  # of a file beside the program
        lines = reader.lines = [*reader.lines, *more]
        heads = [PROGRAM.match(content_of(text)) for text in lines]
        for number in range(1, 10):
            said = [k for k, head in enumerate(heads) if head and head[1] == str(number)]
            assert places.program(number) == (said[0] if said else None)
        named = [k for k, head in enumerate(heads) if head and head[2] == "name"]
        assert places.program("name") == (named[0] if named else None)
        for line in range(len(lines)):
            bounds = places.around(line)
            assert bounds == bounds_by_every_line(lines, line)
            for number in (10, 20, 30, 40, 50, int(30 * "9")):
                for here in range(bounds[0], bounds[1] + 1):
                    found = places.block(number, here, *bounds)
                    known = block_by_every_line(lines, number, here, *bounds)
                    assert found == (known if number < 10**18 else None)


SECTIONS = ("%_N_A_MPF", "%_N_B_SPF", "; nothing", "PROC B", "N10 PROC C(REAL X)", "G1 X1", "",
            "%_N_C_SPF", "A: G1 X2", "proc a")  # fmt: skip


def program_by_every_line(lines, name):
    def head(k):
        section, part = text_places.SECTION.match(lines[k]), text_places.PROCEDURE.match(lines[k])
        return section, part

    for k in range(len(lines)):
        section, part = head(k)
        said = (section or part)[1].upper() if section or part else ""
        names_all = part and not any(line.split(";")[0].strip() for line in lines[:k])
        if said == name and not names_all:
            ends = (j for j in range(k + 1, len(lines)) if head(j)[0] or (part and head(j)[1]))
            return (k + 1 if section else k), next(ends, len(lines))
    return None


@pytest.mark.parametrize("seed", range(40))
def test_sections_and_procedures_are_those_of_a_search_through_all_lines(seed):
    lines = random_text(seed, SECTIONS, lines=12)
    places = TextPlaces(lines, lambda line: None)
    for name in "ABCD":
        assert places.program(name.lower()) == program_by_every_line(lines, name)


def test_label_above_the_block_comes_before_one_below():
    lines = ["A: X1", "B: X2", "A: X3", "X4", "A: X5", "B: X6"]
    places = TextPlaces(lines, lambda line: line.partition(":")[0])
    assert places.label("a", range(3), range(4, 6)) == 2
    assert places.label("A", range(1, 2), range(4, 6)) == 4
    assert places.label("B", range(0), range(3, 6)) == 5
    assert places.label("B", range(0), range(3, 5)) is None


CALLS = 60
PROGRAMS = {
    "M98": ("O1\nF9\n" + "M98 P7\n" * CALLS + "M30\nO7\nG1 X1.\nM99\n", line_places, "content_of"),
    "GOTO": ("O1\nF9\n#1=0\nN5 #1=#1+1\nG1 X#1\nIF[#1LT60]GOTO5\n" + "N9 G1 X1.\n" * CALLS
             + "M30\n", line_places, "_number"),
    "CALL LBL": ("BEGIN PGM A MM\nL F9\n" + "CALL LBL 1\n" * CALLS
                 + "L M30\nLBL 1\nL X+1\nLBL 0\nEND PGM A MM\n", heidenhain.KlartextReader,
                 "content"),
    "SPF": ("%_N_A_MPF\nG71 F9\n" + "PART\n" * CALLS + "M30\n%_N_PART_SPF\nG1 X1\nM17\n",
            text_places, "_head"),
    "REPEAT": ("G71 F9\nGOTOF BEGIN\nPART: G1 X1\nEND1: G1 X2\nBEGIN: G1 X0\n"
               + "REPEAT PART END1\n" * CALLS + "M30\n", sinumerik.SinumerikReader, "content"),
}  # fmt: skip


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_text_is_looked_through_once_however_often_it_calls(name, monkeypatch):
    text, owner, looked = PROGRAMS[name]
    seen, before = [], getattr(owner, looked)

    def counted(*arguments):
        seen.append(arguments)
        return before(*arguments)

    monkeypatch.setattr(owner, looked, counted)
    assert len(read_program(Source(text.encode(), "part.nc")).moves.line) >= CALLS
    assert len(seen) <= 8 * text.count("\n")
