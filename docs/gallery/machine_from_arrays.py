"""Can a machine be made without any file?

Give travel, error tables and squareness as arrays, and ask for the volumetric accuracy.
"""

import numpy as np

import vmach

x_mm = np.linspace(-500.0, 0.0, 21)
y_mm = np.linspace(-400.0, 0.0, 17)

machine = vmach.machine_from_arrays(
    "my mill",
    travel_mm={"X": (-500.0, 0.0), "Y": (-400.0, 0.0), "Z": (-300.0, 0.0)},
    errors={
        "EXX": (x_mm, 0.02 * (x_mm + 500.0)),  # 20 um/m too long
        "EBX": (x_mm, 15.0 * np.sin(np.pi * x_mm / 500.0)),  # pitch, urad
        "EYY": (y_mm, 4.0 * np.cos(np.pi * y_mm / 400.0)),
    },
    measured_at_mm={"EXX": (0.0, 0.0, -250.0), "EYY": (0.0, 0.0, -250.0)},
    squareness_urad={"EC0Y": 30.0},
)

for length_mm in (0.0, 100.0, 200.0):
    found = vmach.accuracy(machine, tool_length_mm=length_mm)
    print(
        f"tool of {length_mm:3.0f} mm: errors of two points differ by up to "
        f"{1e3 * found.largest_difference_mm:.1f} um"
    )
