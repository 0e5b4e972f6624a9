"""The machine: its chain, its component errors and the displacement of the tool they cause."""

from vmach.base.variant import Variant
from vmach.machine.chain import LINEAR_AXES, Chain
from vmach.machine.component_errors import COMPONENT_NAMES, ComponentError
from vmach.machine.displacement import RigidDisplacement, contributions, displacement
from vmach.machine.files.machine_file import read_machine
from vmach.machine.machine import Axis, Machine, Motion
from vmach.machine.machine_axes import in_machine_axes

__all__ = [
    "COMPONENT_NAMES",
    "LINEAR_AXES",
    "Axis",
    "Chain",
    "ComponentError",
    "Machine",
    "Motion",
    "RigidDisplacement",
    "Variant",
    "contributions",
    "displacement",
    "in_machine_axes",
    "read_machine",
]
