"""``vmach accuracy MACHINE``: volumetric accuracy, what it comes from, and pictures."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from vmach.base.progress import progress_bar
from vmach.base.terminal import console
from vmach.base.uncertainty_method import UncertaintyMethod
from vmach.base.variant import Variant
from vmach.commands.options import (
    AsJson,
    Digits,
    Draws,
    Model,
    Seed,
    Uncertainty,
    command_line,
    draw_plan,
)
from vmach.files.atomic import atomic_folder, check_folder

__all__ = ["accuracy"]

_PROFILE_SPACING_MM = 5.0
#: what may lie in the folder for results
_PAGE = "accuracy.html"
_FILES = (_PAGE, "accuracy.json", "histogram.png", "cones.png", "htm_abbe.png", "profile.png")


def accuracy(
    machine: Annotated[Path, typer.Argument(metavar="MACHINE", help="machine.toml")],
    tool_length: Annotated[
        float, typer.Option(min=0.0, max=1e4, help="from spindle nose to tip along Z, mm")
    ] = 0.0,
    model: Model = Variant.ABBE,
    grid: Annotated[str, typer.Option(help="points along X,Y,Z; one number for all")] = "21",
    volume: Annotated[
        str | None, typer.Option(help="reduced volume: xmin,xmax,ymin,ymax,zmin,zmax of the nose")
    ] = None,
    profile: Annotated[
        Path | None,
        typer.Option(help="CSV x,y,z of nose positions: a path to give the error along"),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="folder for page, json and pictures")
    ] = None,
    uncertainty: Uncertainty = UncertaintyMethod.FIRST_ORDER,
    digits: Digits = 1,
    draws: Draws = 1_000_000,
    seed: Seed = 1,
    as_json: AsJson = False,
) -> None:
    """Evaluate the volumetric accuracy of a machine."""
    import numpy as np

    from vmach.plausibility import admitted_machine
    from vmach.volumetric.field import error_field
    from vmach.volumetric.figures import accuracy_figures, arms_compared, profile_figures
    from vmach.volumetric.printing import print_accuracy
    from vmach.volumetric.profile import read_profile
    from vmach.volumetric.volume_text import volume_of

    known = admitted_machine(machine)
    if out is not None:
        check_folder(out, _FILES, inputs=[*known.files, *([profile] if profile else [])])
    tool_mm = np.array([0.0, 0.0, -tool_length])
    space = volume_of(known, volume, grid)
    with progress_bar() as progress:
        progress("evaluate", 0, 1)
        field = error_field(known, space, tool_mm, model)
        comparison = arms_compared(known, tool_mm, {model: field})
        path = None
        if profile is not None:
            path = read_profile(profile).divided(_PROFILE_SPACING_MM).errors(known, tool_mm, model)
        report = accuracy_figures(known, field, comparison, tool_mm, model=model)
        if path is not None and profile is not None:
            report["profile"] = profile_figures(profile, path)
        plan = draw_plan(uncertainty, digits, draws, seed)
        if plan is not None:
            from vmach.uncertainty.volumetric import draw_accuracy
            from vmach.uncertainty.volumetric_figures import accuracy_drawn_figures

            drawn = draw_accuracy(known, field, tool_mm, model, plan, progress=progress)
            report["uncertainty"] = accuracy_drawn_figures(drawn)
        if out is not None:
            # late: drawing takes a second to load
            from vmach.volumetric.cones import cone_volume
            from vmach.volumetric.page.page import accuracy_page
            from vmach.volumetric.pictures import accuracy_pictures, dark_pictures

            coarse = error_field(known, cone_volume(space), tool_mm, model)
            draw = partial(
                accuracy_pictures, known, field, coarse, comparison, profile=path, model=model
            )
            pictures = draw()
            with dark_pictures():
                dark = draw()
            page = accuracy_page(report, coarse, pictures, dark_pictures=dark,
                                 command=command_line())  # fmt: skip
            _write(out, report, pictures, page)
    if as_json:
        print(json.dumps(report, indent=1))
    else:
        print_accuracy(console(), report)


def _write(out: Path, report: dict[str, Any], pictures: dict[str, bytes], page: str) -> None:
    with atomic_folder(out) as folder:
        (folder / _PAGE).write_text(page, encoding="utf-8")
        for name, picture in pictures.items():
            (folder / name).write_bytes(picture)
        (folder / "accuracy.json").write_text(json.dumps(report, indent=1) + "\n")
