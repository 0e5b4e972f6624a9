"""Error tables that do not hold: the control compensates them, or their sign is reversed."""

from dataclasses import replace

from vmach.effects.effect import Effect
from vmach.effects.parameter import linear
from vmach.machine import COMPONENT_NAMES, RigidDisplacement

__all__ = ["ErrorTables"]

#: no control errs by more of its tables: reversed is -2; with half of that as margin, as tables
#: and compensation may be of different years
_MOST = 3.0


class ErrorTables(Effect):
    """The machine errs by another share of its tables: by none, or by as much the other way.

    A table that was measured while the control did not compensate it counts twice where it does
    now. A deviation is actual minus nominal; many a file has the correction, nominal minus actual.
    """

    name = "error_tables"
    title = "error tables that the control compensates, or whose sign is reversed"
    commonness = 0
    shows_as = "what the error tables foretell is not there, or the other way"
    law = "share × (displacement by all error tables)"
    source = (
        "equation (35) of docs/laws.md; ISO 230-1, error motions; ISO/TR 16907, numerical "
        "compensation; closed form derived here: what is foretold is in proportion to the tables"
    )
    parameters = (
        replace(
            linear("share", "beside what the tables say: -1 compensated, -2 reversed", usual=1.5),
            most=_MOST,
        ),
    )
    targets = ("all", "tables", *COMPONENT_NAMES)
    turns_tool = True
    rarity = 1.0
    usual_size = "-1 or -2"
    confirm = "measure one axis with the compensation on; compare the sign with the file's"
    cure = "turn the sign round, or leave out of the machine file what the control compensates"

    def displacement(self, path, target, share):
        machine = path.job.machine
        total = RigidDisplacement.zero(len(path))
        for name, own in path.of_each_error.items():
            if target in ("all", name) or (target == "tables" and name in machine.components):
                total = total + own
        return RigidDisplacement(share * total.shift_mm, share * total.tilt_rad)

    def not_testable(self, path, target):
        machine = path.job.machine
        if target == "tables" and not machine.squareness_rad.any():
            return "the machine file has no squareness beside its tables"
        wanted = machine.components if target in ("all", "tables") else (target,)
        there = [name for name in wanted if name in machine.components]
        return None if there else f"the machine file has no table {target}"
