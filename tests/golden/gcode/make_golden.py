"""Write what LinuxCNC's interpreter makes of every program here: NAME.canon or NAME.reject.

Needs LinuxCNC (Debian: linuxcnc-uspace) and its own Python:

    /usr/bin/python3 tests/golden/gcode/make_golden.py

A program is accepted where ``rs274 -g`` accepts it. The canonical calls then come from the same
interpreter through the module ``gcode`` of LinuxCNC, which gives all digits in inches; they are
written in mm. ``tool.tbl`` is in inches, the machine unit of the interpreter without INI file.
"""

import ctypes
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
#: call -> how many leading arguments are X Y Z, or positions of lengths
LENGTHS = {
    "straight_feed": (0, 1, 2),
    "straight_traverse": (0, 1, 2),
    "straight_probe": (0, 1, 2),
    "rigid_tap": (0, 1, 2),
    "tool_offset": (0, 1, 2),
    "set_g92_offset": (0, 1, 2),
    "set_g5x_offset": (1, 2, 3),
    "arc_feed": (0, 1, 2, 3, 5),
    "set_feed_rate": (0,),
}
KEPT = {*LENGTHS, "dwell", "set_plane", "set_xy_rotation", "change_tool"}
PARAMETERS = "5220\t1.0\n"


def tool_rows(path):
    rows = {}
    for pocket, text in enumerate(path.read_text().splitlines(), 1):
        words = {k: float(v) for k, v in re.findall(r"([TDXYZ])([-.\d]+)", text.split(";")[0])}
        offset = [words.get(axis, 0.0) for axis in "XYZ"] + [0.0] * 6
        rows[pocket] = (int(words["T"]), *offset, words.get("D", 0.0), 0.0, 0.0, 0)
    return rows


class Canon:
    """Answers LinuxCNC's interpreter and prints what it says."""

    use_move_batches = False

    def __init__(self, parameter_file, tools):
        self.parameter_file, self.tools, self.line, self.pocket = parameter_file, tools, 0, 0

    def next_line(self, state):
        self.line = state.sequence_number

    def change_tool(self, pocket):
        self.pocket = pocket
        print(self.line, "change_tool", pocket)

    def get_tool(self, pocket):
        return self.tools.get(pocket or self.pocket, (-1, *[0.0] * 12, 0))

    def get_external_length_units(self):
        return 1.0 / 25.4

    def get_external_angular_units(self):
        return 1.0

    def get_axis_mask(self):
        return 0b111111

    def get_block_delete(self):
        return 0

    def check_abort(self):
        return 0

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)

        def say(*values):
            if name in KEPT:
                scale = LENGTHS.get(name, ())
                mm = [v * 25.4 if i in scale else v for i, v in enumerate(values)]
                print(self.line, name, *(repr(v + 0.0 if type(v) is float else v) for v in mm))

        return say


def interpret(program, table, parameters):
    """Child process: print the calls of one program."""
    import gcode  # LinuxCNC's

    library = ctypes.CDLL("libtooldata.so.0", mode=ctypes.RTLD_GLOBAL)
    library._Z17tool_mmap_creatorPK13EMC_TOOL_STATi(None, 0)
    library._Z13tooldata_loadPKcPPc(table.encode(), None)
    result, line = gcode.parse(program, Canon(parameters, tool_rows(Path(table))), "G21", "")
    if result > gcode.MIN_ERROR:
        sys.exit(f"line {line}: {gcode.strerror(result)}")


def golden(program):
    for suffix in (".canon", ".reject"):
        program.with_suffix(suffix).unlink(missing_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "HOME": folder}
        table, parameters = f"{folder}/tool.tbl", f"{folder}/rs274.var"
        Path(table).write_text((HERE / "tool.tbl").read_text())

        def run(*command):
            Path(parameters).write_text(PARAMETERS)
            return subprocess.run(
                command,
                cwd=folder,
                env=environment,
                capture_output=True,
                text=True,
                timeout=20,
                check=False,
            )

        judged = run("rs274", "-t", table, "-v", parameters, "-n", "2", "-g", str(program))
        if judged.returncode:
            said = [s for s in judged.stderr.splitlines() if not s.startswith("executing")]
            program.with_suffix(".reject").write_text("\n".join(said[-2:]) + "\n")
            return "refused"
        told = run(sys.executable, __file__, str(program), table, parameters)
        if told.returncode:
            return f"failed: {told.stderr.strip()}"
        program.with_suffix(".canon").write_text(told.stdout)
        return f"{len(told.stdout.splitlines())} calls"


if __name__ == "__main__":
    if len(sys.argv) == 4:
        interpret(*sys.argv[1:])
    else:
        for source in sorted(HERE.glob("*.ngc")):
            print(source.name, golden(source))
