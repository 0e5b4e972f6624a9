"""What a drawing asks of a feature, one line of text: ``35 H7``, ``position Ø0.05 A B C``.

Source: ISO 1101 (characteristics and tolerance frames), ISO 14405-1 (sizes and their modifiers),
ISO 129-1 (limit deviations).
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from vmach.errors import InputError
from vmach.features.drawing.fits import fit_limits_mm

__all__ = ["CHARACTERISTICS", "Callout", "distance_to_itself", "read_callout"]

#: geometrical characteristics: the fewest and the most datums of each
CHARACTERISTICS = {
    "straightness": (0, 0),
    "flatness": (0, 0),
    "roundness": (0, 0),
    "cylindricity": (0, 0),
    "profile of line": (0, 3),
    "profile": (0, 3),
    "parallelism": (1, 3),
    "perpendicularity": (1, 3),
    "angularity": (1, 3),
    "position": (0, 3),
    "coaxiality": (1, 1),
    "symmetry": (1, 3),
    "circular runout": (1, 2),
    "total runout": (1, 2),
}

#: other names that people and drawings use
_ALIASES = {
    "circularity": "roundness",
    "concentricity": "coaxiality",
    "squareness": "perpendicularity",
    "profile of surface": "profile",
    "surface profile": "profile",
    "line profile": "profile of line",
    "runout": "circular runout",
}

#: of ISO 14405-1: two-point, least squares, maximum inscribed, minimum circumscribed, envelope
SIZE_MODIFIERS = ("LP", "GG", "GX", "GN", "E")

_NUMBER = r"\d+(?:\.\d*)?|\.\d+"
_SIGNED = rf"[+−-]?\s*(?:{_NUMBER})"
_SIZE = re.compile(
    rf"""(?:(?P<what>distance|size)\s+)?(?P<sign>S?[ØøΦ⌀]|S?R)?\s*(?P<nominal>{_NUMBER})(?![\d.,])\s*(?:mm)?\s*
    (?:(?P<fit>[A-Za-z]{{1,2}}\d{{1,2}})
     |(?:±|\+/-|\+-)\s*(?P<both>{_NUMBER})
     |(?P<one>{_SIGNED})\s*(?:/|,(?!\d)|\s)\s*(?P<other>{_SIGNED}))\s*(?:mm)?
    (?:\s+to\s+(?P<to>\S.*?))?(?:\s*\(?(?P<modifier>{"|".join(SIZE_MODIFIERS)})\)?)?""",
    re.VERBOSE,
)
_FRAME = re.compile(
    rf"""(?P<zone>S?[ØøΦ⌀])?\s*(?P<value>{_NUMBER})(?:\s*mm\b)?(?P<rest>.*)""", re.VERBOSE
)
_ALONG = re.compile(r"\balong\s+([XYZ])\b")
_DATUM = re.compile(r"[A-Z](?:-[A-Z])?")
_EXAMPLE = "'35 H7', '40 ±0.02', '12 +0.1 0', 'distance 25 ±0.1 to bottom', 'position Ø0.05 A B'"


@dataclass(frozen=True)
class Callout:
    """One requirement.

    Attributes
    ----------
    text : str
        As written.
    characteristic : str
        ``size``, ``distance`` or one of `CHARACTERISTICS`.
    tolerance_mm : float
        Width or diameter of the zone; for sizes the difference of their limits.
    zone : str
        Empty, ``Ø`` or ``SØ``.
    datums : tuple of str
        Letters, or common datums such as ``A-B``.
    along : str
        Axis that a zone between planes, or the lines of a straightness, are taken along.
    nominal_mm, lower_mm, upper_mm : float
        Of sizes and distances, the limits as values.
    modifier : str
        One of `SIZE_MODIFIERS`.
    is_radius : bool
        The size is a radius.
    to : str
        The other feature of a distance.
    """

    text: str
    characteristic: str
    tolerance_mm: float
    zone: str = ""
    datums: tuple[str, ...] = ()
    along: str = ""
    nominal_mm: float = 0.0
    lower_mm: float = 0.0
    upper_mm: float = 0.0
    modifier: str = "LP"
    is_radius: bool = False
    to: str = ""

    @property
    def is_size(self) -> bool:
        """Whether it has a nominal value and two limits."""
        return self.characteristic in ("size", "distance")


def read_callout(text: str) -> Callout:
    """Read one requirement as it stands on a drawing.

    Raises
    ------
    InputError
        Text that says neither a size nor a characteristic, or not what it needs.
    """
    words = text.strip()
    if words.startswith("distance") or words[:1].isdigit() or words[:1] in "ØøΦ⌀SR.":
        size = _SIZE.fullmatch(words)
        if size:
            return _read_size(text, size)
    for name in sorted((*CHARACTERISTICS, *_ALIASES), key=len, reverse=True):
        if words.lower().startswith(name):
            return _read_frame(text, _ALIASES.get(name, name), words[len(name) :])
    known = ", ".join(CHARACTERISTICS)
    raise InputError(
        f"tolerance {text!r}", accepted=f"{_EXAMPLE}; or a value after {known}", hint=_hint(words)
    )


def distance_to_itself(callout: Callout, feature: str) -> InputError:
    """The error for a distance whose two ends are one feature."""
    same = "itself" if callout.to == feature else f"{callout.to!r}, which has the same faces"
    return InputError(
        f"tolerance {callout.text!r} of {feature!r} is a distance to {same}",
        accepted="the name of another feature or face behind 'to'",
        hint="the size of one feature is written without 'distance', as '40 ±0.02'",
    )


def _hint(words: str) -> str | None:
    """What to do about a comma, a power of ten, another unit or a modifier; None without one."""
    for pattern, said in _SLIPS:
        if re.search(pattern, words):
            return said
    return None


#: what drawings of other offices say, and what to write
_SLIPS = (
    (r"\d,\d", "decimals follow a point"),
    (r"\d[eE][+-]?\d", "without a power of ten: 0.001"),
    (r"(?i)\d\s*(?:[uµμ]m|microns?|in|inch|mil|thou|[\"″])(?![a-z])", "values are in mm"),
    (
        r"[ⓂⓁⓅⒻ]|\([MLPFT]\)|\d[MLPFT]\b|\b(?:CZ|SZ|UZ|MMC|LMC)\b",
        "maximum material and other modifiers are not evaluated",
    ),
)


def _read_size(text: str, found: re.Match) -> Callout:
    nominal = float(found["nominal"])
    if found["fit"]:
        low, high = fit_limits_mm(nominal, found["fit"])
    elif found["both"]:
        low, high = -float(found["both"]), float(found["both"])
    else:
        low, high = sorted(_signed(found[name]) for name in ("one", "other"))
    if not low < high:
        raise InputError(
            f"tolerance {text!r}: both limits are {low + 0.0:g} mm", accepted="two limits"
        )
    is_distance = found["what"] == "distance"
    if is_distance and not found["to"]:
        raise InputError(f"tolerance {text!r}", accepted="'distance 25 ±0.1 to NAME'")
    if found["to"] and not is_distance:
        raise InputError(
            f"tolerance {text!r}: a size of one feature goes to no other",
            accepted="'40 ±0.02', or 'distance 40 ±0.02 to NAME'",
        )
    return Callout(
        text=text.strip(),
        characteristic="distance" if is_distance else "size",
        tolerance_mm=high - low,
        zone=(found["sign"] or "").replace("R", "").translate(_DIAMETER),
        nominal_mm=nominal,
        lower_mm=nominal + low,
        upper_mm=nominal + high,
        modifier=found["modifier"] or "LP",
        is_radius="R" in (found["sign"] or ""),
        to=(found["to"] or "").strip(),
    )


_DIAMETER = str.maketrans({c: "Ø" for c in "øΦ⌀"})


def _signed(text: str) -> float:
    return float(text.replace("−", "-").replace(" ", ""))


def _read_frame(text: str, name: str, rest: str) -> Callout:
    along = _ALONG.search(rest)
    rest = _ALONG.sub(" ", rest).replace("|", " ")
    found = _FRAME.fullmatch(rest.strip())
    if not found or float(found["value"]) <= 0.0:
        raise InputError(
            f"tolerance {text!r}",
            accepted=f"'{name} 0.05' and letters of datums, a value above 0",
            hint=_hint(rest),
        )
    datums = found["rest"].replace(",", " ").split()
    wrong = [word for word in datums if not _DATUM.fullmatch(word)]
    twice = [word for word in datums if word[:1] == word[2:]]
    if found["rest"][:1].isalpha():
        wrong = [found["rest"].split()[0]]
    if wrong:
        raise InputError(
            f"tolerance {text!r}: {wrong[0]!r} is no datum",
            accepted="capital letters, as A, B or A-B; 'along X'",
            hint=_hint(rest),
        )
    if twice:
        letter = twice[0][0]
        raise InputError(
            f"tolerance {text!r}: datum {twice[0]!r} has the letter {letter} twice",
            accepted=f"one letter, as {letter}, or two different ones, as A-B",
            hint=f"{letter} alone is the datum of all faces of its feature",
        )
    fewest, most = CHARACTERISTICS[name]
    if not fewest <= len(datums) <= most:
        count = str(fewest) if fewest == most else f"{fewest} to {most}"
        raise InputError(
            f"tolerance {text!r} has {len(datums)} datums", accepted=f"{count} with {name}"
        )
    zone = (found["zone"] or "").translate(_DIAMETER)
    return Callout(
        text=text.strip(),
        characteristic=name,
        tolerance_mm=float(found["value"]),
        zone=zone,
        datums=tuple(datums),
        along=along.group(1) if along else "",
    )
