"""What are accuracy, repeatability and reversal of my axis after ISO 230-2?

Five bidirectional runs at eleven targets, made here with a seed.
"""

import numpy as np

import vmach

random = np.random.default_rng(seed=2)
position_mm = np.linspace(0.0, 500.0, 11)
slow_um = 0.01 * position_mm + 2.0 * np.sin(position_mm / 80.0)
forward_um = slow_um + random.normal(scale=0.4, size=(5, 11))
backward_um = slow_um - 3.0 + random.normal(scale=0.4, size=(5, 11))

found = vmach.evaluate_axis(position_mm, forward_um, backward_um)
print(f"A = {found.A:.2f} um, R = {found.R:.2f} um, E = {found.E:.2f} um")
print(f"M = {found.M:.2f} um, B = {found.B:.2f} um, mean reversal {found.B_mean:+.2f} um")
