"""How the part of a job is looked at, and what is known of the machine that measured it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vmach.base.units import mm_from_um
from vmach.errors import InputError
from vmach.features.circular_test import CircularLimits
from vmach.job.schema import CircularTestEntry, InspectionEntry, MeasuringMachineEntry

__all__ = ["Device", "Inspection", "read_circular_limits", "read_device", "read_inspection"]


@dataclass(frozen=True)
class Inspection:
    """How the part is looked at; lengths in mm."""

    spacing_mm: float
    edge_margin_mm: float
    reach_mm: float
    tolerance_mm: float
    difference_mm: float
    alignment: str
    datums: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Device:
    """What is known of the coordinate measuring machine; standard uncertainties but for the form.

    Attributes
    ----------
    scale_u, squareness_u_rad : float
        Of each scale, in mm/mm, and of each squareness.
    probing_form_mm : float
        Range of the radial distances of a sphere, P_Form of ISO 10360-5; 0 where not stated.
    feature_u_mm : float
        Of what all points of a feature have in common; 0 where not stated.
    clamping_u_mm : float or None
        Of a shift of the part in each clamping on the machine, which a turn makes at the end of
        the part as well; None where not stated.
    """

    scale_u: float
    squareness_u_rad: float
    probing_form_mm: float = 0.0
    feature_u_mm: float = 0.0
    clamping_u_mm: float | None = None


def read_inspection(data: InspectionEntry, where: dict[str, Any]) -> Inspection:
    """The table ``[inspection]`` of a job file.

    Raises
    ------
    InputError
        An alignment to datums without any.
    """
    if data.alignment == "datum" and not data.datums:
        raise InputError(
            f'alignment = "{data.alignment}" needs datums',
            **where,
            accepted='lists of feature names: datums = [["top"], ["side *"], ["bore 1"]]',
        )
    return Inspection(
        spacing_mm=data.spacing_mm,
        edge_margin_mm=data.edge_margin_mm,
        reach_mm=data.reach_mm,
        tolerance_mm=mm_from_um(data.tolerance_um),
        difference_mm=data.difference_mm,
        alignment=data.alignment,
        datums=tuple(map(tuple, data.datums)),
    )


def read_device(data: MeasuringMachineEntry) -> Device:
    """The limit L/K of a length as a rectangular distribution, where nothing else is stated."""
    share = 1e-3 / data.k_mm_per_um / np.sqrt(3.0)
    scale, square = data.scale_u_ppm, data.squareness_u_urad
    return Device(
        scale_u=share if scale is None else 1e-6 * scale,
        squareness_u_rad=share if square is None else 1e-6 * square,
        probing_form_mm=mm_from_um(data.probing_form_um),
        feature_u_mm=mm_from_um(data.feature_u_um),
        clamping_u_mm=None if data.clamping_u_um is None else mm_from_um(data.clamping_u_um),
    )


def read_circular_limits(data: CircularTestEntry | None) -> CircularLimits | None:
    """The table ``[circular_test]``; None where no figure of ISO 230-4 is asked for."""
    if data is None:
        return None
    told = data.model_dump(exclude_none=True)
    return CircularLimits(**{key.removesuffix("_um"): mm_from_um(um) for key, um in told.items()})
