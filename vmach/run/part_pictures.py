"""Mesh and stills of a run, drawn as soon as all that they show is known."""

from __future__ import annotations

from pathlib import Path

from vmach.job import job_name
from vmach.nominal.patches import patches
from vmach.report import DisplayMesh, RunRecord, build_display_mesh
from vmach.run.pipeline import MachinedPart, PartInspection

__all__ = ["HEATMAP_FILE", "REMAINDER_FILE", "PartPictures", "display_mesh"]

HEATMAP_FILE = "heatmap.png"
#: measured minus predicted, beside the others where the part was measured
REMAINDER_FILE = "remainder.png"


class PartPictures:
    """What `write_results` shows of a part.

    A job with CAD is drawn on it, so `draw` may be the `meanwhile` of `machine_part`: then the
    pictures are ready when the solid is.

    Attributes
    ----------
    mesh : DisplayMesh or None
        None until it is drawn.
    """

    def __init__(self) -> None:
        self.mesh: DisplayMesh | None = None
        self._stills: dict[str, bytes] = {}

    def draw(self, found: PartInspection) -> None:
        """Draw what is not yet drawn; a part without CAD waits for its solid."""
        if self.mesh is not None or (found.nominal is None and not isinstance(found, MachinedPart)):
            return
        from vmach.report.pictures.heatmap import heatmap_png  # late: it loads matplotlib

        self.mesh = display_mesh(found)
        captions = RunRecord(title=job_name(found.job.path), command="", model="",
                             tolerance_mm=found.job.inspection.tolerance_mm,
                             features=found.features)  # fmt: skip
        self._stills[HEATMAP_FILE] = heatmap_png(self.mesh, found.points, captions)
        if found.points.remainders:
            shown, names = found.points.with_remainders(), [v.name for v in found.points.remainders]
            self._stills[REMAINDER_FILE] = heatmap_png(self.mesh, shown, captions, columns=names)

    def write_stills(self, folder: Path) -> list[Path]:
        """Write the pictures into a folder."""
        for name, png in self._stills.items():
            (folder / name).write_bytes(png)
        return [folder / name for name in self._stills]


def display_mesh(found: PartInspection) -> DisplayMesh:
    """The nominal CAD with the deviations on it, else the virtual part, else a patch a point."""
    if found.nominal is not None:
        mesh = found.nominal.mesh
    elif isinstance(found, MachinedPart) and found.part is not None:
        mesh = found.part
    else:
        mesh = patches(found.points.point_mm, found.points.normal)
    return build_display_mesh(mesh.vertices_mm, mesh.triangles, found.points)
