"""Reading ``machine.toml`` with its error tables."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vmach.base.units import mm_from_um, rad_from_urad
from vmach.errors import InputError
from vmach.files.toml_file import line_of_key, read_toml_and_text
from vmach.machine.chain import LINEAR_AXES, Chain
from vmach.machine.component_errors import COMPONENT_NAMES, ComponentError, component_of
from vmach.machine.counted_positions import in_machine_coordinates
from vmach.machine.files.machine_schema import CROSS_VALIDATION, MachineSchema, TableEntry
from vmach.machine.files.rotary_file import is_rotary_error, read_rotary_axes
from vmach.machine.files.volumetric_file import VolumetricFile, read_volumetric_file
from vmach.machine.machine import Axis, Machine, Motion
from vmach.machine.measuring_uncertainty import MeasuringUncertainty
from vmach.machine.sign_convention import SignConvention
from vmach.machine.squareness import agreed_value, squareness_vectors
from vmach.machine.tables.cross_validation import choose, cross_validate
from vmach.machine.tables.error_table import MM_PER, RAD_PER, ErrorTable, read_error_table
from vmach.machine.tables.interpolation import Extrapolation, Interpolation, Method

__all__ = ["read_machine"]


def read_machine(path: str | Path) -> Machine:
    """Read a machine file and the tables that it names.

    Raises
    ------
    InputError
        Anything wrong with the files, with file, line, key, value and what is accepted.
    """
    path = Path(path)
    data, text = read_toml_and_text(path, MachineSchema, what="machine file")
    source = _Source(path, data, text)
    chain = source.chain()
    source.check_axes(chain)
    volumetric = VolumetricFile()
    files = [entry.table for entry in data.errors.values() if entry.table]
    if data.volumetric is not None:
        volumetric = source.volumetric()
        files.append(data.volumetric.file)
    linear = [name for name in data.errors if not is_rotary_error(name)]
    names = dict.fromkeys((*linear, *volumetric.tables))
    tables = {name: source.table(name, volumetric) for name in names}
    squareness = {name: source.squareness_rad(name) for name in data.squareness}
    return Machine(
        name=data.name,
        chain=chain,
        axes={name: Axis(*data.axes[name].travel_mm) for name in LINEAR_AXES},
        motion=Motion(
            data.motion.rapid_mm_min, data.motion.tool_change_s, data.motion.acceleration_mm_s2
        ),
        components={name: source.component(name, table, chain) for name, table in tables.items()},
        squareness_rad=squareness_vectors(volumetric.squareness_rad | squareness),
        sign=SignConvention(data.convention.sign),
        separate_directions=data.tables.directions == "separate",
        rotary=read_rotary_axes(data, chain.rotary_axes, folder=path.parent, fail=source.fail),
        reference_axes=data.convention.reference_axes or "",
        files=(path, *(path.parent / name for name in dict.fromkeys(files))),
        notes=tuple(
            replace(note, subject=name) for name, table in tables.items() for note in table.notes
        ),
        uncertainty=_uncertainty(data),
    )


def _uncertainty(data: MachineSchema) -> MeasuringUncertainty:
    stated = data.uncertainty
    return MeasuringUncertainty(
        reading_mm=None if stated.reading_um is None else mm_from_um(stated.reading_um),
        reading_rad=None if stated.reading_urad is None else rad_from_urad(stated.reading_urad),
        squareness_rad=(
            None if stated.squareness_urad is None else rad_from_urad(stated.squareness_urad)
        ),
        positioning_share=stated.positioning_um_per_m * RAD_PER["um/m"],
        measured_at_mm=stated.measured_at_mm,
    )


@dataclass(frozen=True)
class _Source:
    """A machine file that was read, and complaints about it with file and line."""

    path: Path
    data: MachineSchema
    text: str

    def fail(
        self, keys: list[str], what: str, accepted: str | None = None, hint: str | None = None
    ) -> InputError:
        line = line_of_key(self.text, keys)
        return InputError(what, file=self.path, line=line, accepted=accepted, hint=hint)

    def existing(self, keys: list[str], name: str) -> None:
        """Complain of a file that is not there where the machine file names it."""
        if not (self.path.parent / name).exists():
            raise self.fail(keys, f"{keys[-1]} = '{name}': no such file")

    def chain(self) -> Chain:
        try:
            return Chain.parse(self.data.chain)
        except InputError as error:
            raise self.fail(["chain"], error.what, error.accepted) from None

    def check_axes(self, chain: Chain) -> None:
        """Every axis of the chain alone has its own keys; linear ones have a travel."""
        for axis, entry in self.data.axes.items():
            linear = axis in LINEAR_AXES
            if not linear and axis not in chain.rotary_axes:
                raise self.fail(
                    ["axes", axis],
                    f"[axes.{axis}]: there is no axis {axis} in the chain",
                    ", ".join((*LINEAR_AXES, *chain.rotary_axes)),
                    "name it in chain, or take the table out",
                )
            known = ("travel_mm",) if linear else ("travel_deg", "centre_mm")
            for key in entry.model_dump(exclude_none=True):
                if key not in known:
                    raise self.fail(
                        ["axes", axis, key],
                        f"{key} of the {'linear' if linear else 'rotary'} axis {axis}",
                        ", ".join(known),
                    )
        self._check_travel()

    def _check_travel(self) -> None:
        for axis in LINEAR_AXES:
            if axis not in self.data.axes or self.data.axes[axis].travel_mm is None:
                raise self.fail(
                    ["axes", *self.data.axes],
                    f"axis {axis} has no travel",
                    "[axes.X], [axes.Y], [axes.Z]",
                )
            low, high = self.data.axes[axis].travel_mm
            if low >= high:
                raise self.fail(
                    ["axes", axis, "travel_mm"], f"travel {low} .. {high} mm", "[low, high]"
                )

    def volumetric(self) -> VolumetricFile:
        """The volumetric file, without the errors that have a table of their own."""
        stated = self.data.volumetric
        self.existing(["volumetric", "file"], stated.file)
        found = read_volumetric_file(self.path.parent / stated.file, stated.format)
        for name in stated.without:
            if name not in found.tables:
                raise self.fail(["volumetric", "without"], f"without {name}, which is not in it",
                                ", ".join(found.tables))  # fmt: skip
        kept = {name: table for name, table in found.tables.items() if name not in stated.without}
        return VolumetricFile(kept, found.squareness_rad)

    def table(self, name: str, volumetric: VolumetricFile) -> ErrorTable:
        """One component error over the positions of its axis."""
        written = self._written_table(name, volumetric)
        entry = self.data.errors.get(name, TableEntry())
        if entry.reverse_deviations is not None and not entry.reverse:
            raise self.fail(
                ["errors", name, "reverse_deviations"],
                f"{name}: reverse_deviations without reverse = true",
                "both, or neither",
            )
        direction, axis, angular = component_of(name)
        counted = bool(entry.reverse_deviations)
        return in_machine_coordinates(
            written,
            entry.position_zero_mm or 0.0,
            reverse=bool(entry.reverse),
            swap=counted,
            negate=counted and direction == axis and not angular,
        )

    def _written_table(self, name: str, volumetric: VolumetricFile) -> ErrorTable:
        """The values of one component error, from its own or from the volumetric file."""
        if name not in COMPONENT_NAMES:
            raise self.fail(
                ["errors", name], f"component error '{name}'", ", ".join(COMPONENT_NAMES)
            )
        entry = self.data.errors.get(name, TableEntry())
        if entry.table and name in volumetric.tables:
            raise self.fail(
                ["errors", name, "table"],
                f"{name} is in '{entry.table}' and in '{self.data.volumetric.file}'",
                "one of them",
                f'without = ["{name}"] under [volumetric] leaves that of the file out',
            )
        if entry.table:
            unit = entry.unit or self._unit(name)
            units = RAD_PER if component_of(name)[2] else MM_PER
            if unit not in units:
                raise self.fail(
                    ["errors", name, "unit"], f"unit '{unit}' of {name}", ", ".join(units)
                )
            self.existing(["errors", name, "table"], entry.table)
            return read_error_table(self.path.parent / entry.table, units, unit)
        if name not in volumetric.tables:
            raise self.fail(["errors", name], f"{name} has no table", 'table = "errors/NAME.csv"')
        position_mm, value = volumetric.tables[name]
        return ErrorTable(position_mm, value, value, None, ())

    def component(self, name: str, table: ErrorTable, chain: Chain) -> ComponentError:
        """The component error with its set-up and its curve."""
        entry = self.data.errors.get(name, TableEntry())
        common = self.data.tables
        interpolation, evidence = self._interpolation(name, entry, table)
        component = ComponentError(
            name,
            table.position,
            table.forward,
            table.backward,
            self._measured_at(name, entry, chain),
            set_up=entry.set_up or self.data.convention.set_up,
            slope_removed=entry.slope_removed,
            interpolation=interpolation,
            extrapolation=entry.extrapolation or common.extrapolation or Extrapolation.REFUSE,
            evidence=evidence,
            runs=table.runs,
            reverse=bool(entry.reverse),
            reverse_deviations=entry.reverse_deviations,
            nose_at_mm=None if entry.nose_at_mm is None else np.array(entry.nose_at_mm, float),
            provenance=entry.provenance or common.provenance or "",
            measured_on=entry.measured_on or common.measured_on,
            source=str(self.path.parent / (entry.table or self.data.volumetric.file)),
        )
        try:
            _ = component.curves
        except InputError as error:
            keys = ["errors", name, "interpolation"]
            raise self.fail(keys, f"{name}: {error.what}", error.accepted, error.hint) from None
        return component

    def _interpolation(self, name: str, entry: TableEntry, table: ErrorTable):
        """The method asked for, or the one that cross-validation chooses, with its evidence."""
        common = self.data.tables
        own = entry.interpolation is not None
        method = entry.interpolation or common.interpolation or Method.LINEAR
        own_keys = [key for key in ("order", "period_mm") if getattr(entry, key) is not None]
        if "period_mm" in own_keys and method != Method.FOURIER:
            raise self.fail(
                ["errors", name, "period_mm"],
                f"{name}: period_mm with interpolation '{method}'",
                "period_mm with 'fourier', with no other",
            )
        if method == CROSS_VALIDATION:
            if "order" in own_keys:
                raise self._order_out_of_place(name, method, entry.order)
            scores = cross_validate(table.position, 0.5 * (table.forward + table.backward))
            return choose(scores), scores
        order = entry.order or (None if own else common.order)
        period = entry.period_mm or (None if own else common.period_mm)
        if (order is not None) != (method in (Method.LEGENDRE, Method.FOURIER)):
            raise self._order_out_of_place(name, method, order)
        return Interpolation(Method(method), order, period), ()

    def _order_out_of_place(self, name: str, method: str, order: int | None) -> InputError:
        return self.fail(
            ["errors", name, "interpolation"],
            f"{name}: interpolation '{method}' "
            + ("without an order" if order is None else f"with order {order}"),
            "order = 1, 2 ... with 'legendre' and 'fourier', with no other",
        )

    def _measured_at(self, name: str, entry: TableEntry, chain: Chain) -> np.ndarray | None:
        """Measuring point in the frame of the body that the axis carries."""
        _, axis, angular = component_of(name)
        keys = ["errors", name]
        by_state = entry.nose_at_mm is not None or entry.stick_out_mm is not None
        if angular and (entry.measured_at_mm is not None or by_state):
            raise self.fail(
                [*keys, "measured_at_mm" if entry.measured_at_mm else "nose_at_mm"],
                f"{name} is an angle, which is the same at every point of the body",
                "a measuring point for positioning and straightness only",
            )
        if by_state:
            if entry.measured_at_mm or entry.nose_at_mm is None or entry.stick_out_mm is None:
                raise self.fail(
                    keys,
                    f"{name} does not state its measuring point in one form",
                    "measured_at_mm, or nose_at_mm together with stick_out_mm",
                )
            tip = np.array([0.0, 0.0, -entry.stick_out_mm])
            return tip + chain.arm_masks[axis] * np.array(entry.nose_at_mm)
        if entry.measured_at_mm is not None:
            return np.array(entry.measured_at_mm, dtype=float)
        if angular or self.data.volumetric is None or entry.table:
            return None
        return np.array(self.data.volumetric.measured_at_mm, dtype=float)

    def squareness_rad(self, name: str) -> float:
        """One squareness, stated in the file's unit or in two units that have to agree."""
        keys = ["squareness", name]
        rotation, zero, axis = (name[1:2], name[2:3], name[3:]) if name[:1] == "E" else ("",) * 3
        if (
            rotation not in tuple("ABC")
            or zero != "0"
            or axis not in LINEAR_AXES
            or ("ABC".index(rotation) == LINEAR_AXES.index(axis))
        ):
            raise self.fail(
                keys,
                f"squareness '{name}'",
                "E, a rotation A, B or C, 0, the axis that is out of square across it: EC0Y",
            )
        value = self.data.squareness[name]
        if isinstance(value, float):
            return value * RAD_PER[self.data.convention.angle]
        try:
            return agreed_value(value.um_per_m, value.arcsec, value.use)
        except InputError as error:
            raise self.fail(keys, f"{name}: {error.what}", error.accepted, error.hint) from None

    def _unit(self, name: str) -> str:
        convention = self.data.convention
        return convention.angle if component_of(name)[2] else convention.length
