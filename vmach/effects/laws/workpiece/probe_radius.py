"""Probe radius: the measuring device finds every surface a little too near or too far."""

import numpy as np

from vmach.effects.effect import Effect
from vmach.effects.parameter import linear

__all__ = ["ProbeRadius"]

#: lobes of a touch trigger probe, as a share of what its radius errs
_LOBING = 0.1


class ProbeRadius(Effect):
    """The same deviation along every normal; touch trigger probes add three weak lobes."""

    name = "probe_radius"
    title = "effective radius of the measuring probe"
    commonness = 10
    shows_as = "every measured surface"
    law = "radius n"
    source = (
        "equation (25) of docs/laws.md; ISO 10360-5, probing systems; closed form derived "
        "here: a radius off by c shifts each surface by n c"
    )
    parameters = (linear("radius_um", "deviation seen on every surface", usual=5.0),)
    targets = ("",)
    needs_surface = True
    rarity = 1.0
    slack_share = _LOBING
    usual_size = "1 to 10 um"
    confirm = "measure a calibrated ring or sphere in the same job"
    cure = "qualify the probe again"

    def displacement(self, path, target, radius_um):
        return 1e-3 * radius_um * path.normal

    def slack(self, path, target, parameters):
        around = 3.0 * np.arctan2(path.normal[:, 1], path.normal[:, 0])
        lobes = np.stack([np.cos(around), np.sin(around)], axis=1)
        size = self.slack_share * 1e-3 * parameters["radius_um"]
        return size * path.side_normal[:, :, None] * lobes[:, None, :]
