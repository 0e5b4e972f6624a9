"""Figures of a measured machine as they are printed, to compare with.

Source: KTH master thesis on the geometric errors of a Mazak AJV-25/405, Tables 4 to 6.
"""

#: what the columns are, ISO 230-2; B_mean is the mean reversal
FIGURES = ("A", "R", "B_mean", "M", "B", "E")
#: of each error; um, and um/mm (mrad) for the angles; None: not printed
PRINTED = {
    "EXX": (18.752, 4.566, 2.367, 14.620, 2.720, 17.100),
    "EYX": (7.62, 3.92, 0.16, 5.62, None, None),
    "EZX": (10.96, 8.88, 0.82, 4.51, None, None),
    "EBX": (0.0212, 0.0057, 0.0, 0.0167, 0.0031, 0.0179),
    "ECX": (0.0133, 0.005, 0.0005, 0.0097, 0.001, 0.0100),
    "EYY": (19.580, 5.174, 2.909, 16.170, 3.440, 18.960),
    "EXY": (21.98, 19.82, 0.06, 3.04, None, None),
    "EZY": (4.79, 3.85, 0.25, 2.45, None, None),
    "EAY": (0.0374, 0.0153, 0.0002, 0.025, 0.0009, 0.0252),
    "ECY": (0.0455, 0.0298, -0.0021, 0.0212, 0.0038, 0.0232),
    "EZZ": (21.835, 16.135, 15.553, 6.090, 15.553, 21.500),
    "EXZ": (13.82, 13.82, -0.44, 1.25, None, None),
    "EYZ": (1.68, 1.45, -0.10, 0.72, None, None),
    "EAZ": (0.0251, 0.0133, -0.0007, 0.0129, 0.0014, 0.0138),
    "EBZ": (0.0553, 0.0314, -0.0016, 0.0259, 0.0037, 0.0280),
}
