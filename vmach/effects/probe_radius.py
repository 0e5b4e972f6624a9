"""Probe radius: the measuring device finds every surface a little too near or too far."""

from vmach.effects.effect import Effect, linear

__all__ = ["ProbeRadius"]


class ProbeRadius(Effect):
    """The same deviation along every normal."""

    name = "probe_radius"
    title = "effective radius of the measuring probe"
    parameters = (linear("radius_um", "deviation seen on every surface", usual=5.0),)
    targets = ("",)
    needs_surface = True
    rarity = 1.0
    usual_size = "1 to 10 um"
    confirm = "measure a calibrated ring or sphere in the same job"
    cure = "qualify the probe again"

    def displacement(self, path, target, radius_um):
        return 1e-3 * radius_um * path.normal
