"""Features of a test part: how each is cut, where it is measured, when the tool touched it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .program_writer import ProgramWriter, Tool

__all__ = ["TOOLS", "Contacts", "FeatureBuilder"]

TOOLS = (Tool(1, 20.0, 150.0, 4500.0), Tool(2, 12.0, 105.0, 8000.0))
#: a floor point is under the tool for a while: shares of the tool's radius that are looked at
FLOOR_SHARES = (-0.95, -0.5, 0.0, 0.5, 0.95)
OVERRUN_MM = 4.0


@dataclass
class Contacts:
    """Rows of moments at which the tool touched a measured point, one list an attribute."""

    point: list = field(default_factory=list)  #: index of the surface point
    tip_mm: list = field(default_factory=list)
    velocity_mm_s: list = field(default_factory=list)
    acceleration_mm_s2: list = field(default_factory=list)
    node: list = field(default_factory=list)
    share: list = field(default_factory=list)
    tool: list = field(default_factory=list)
    ae_mm: list = field(default_factory=list)
    ap_mm: list = field(default_factory=list)
    geometry_mm: list = field(default_factory=list)  #: what chords in the program leave
    set_up: list = field(default_factory=list)  #: 0 for G54, 1 for G55

    def add(self, **row) -> None:
        """One moment."""
        row = {"acceleration_mm_s2": np.zeros(3), "geometry_mm": 0.0, "set_up": 0, **row}
        for name, value in row.items():
            getattr(self, name).append(value)


class FeatureBuilder:
    """Cuts features one after the other and remembers their measured points and moments."""

    def __init__(self, rng: np.random.Generator, writer: ProgramWriter):
        self.rng, self.writer = rng, writer
        self.feature, self.place, self.normal, self.contacts = [], [], [], Contacts()

    def point(self, feature: str, place: np.ndarray, normal: np.ndarray) -> int:
        self.feature.append(feature)
        self.place.append(np.round(place, 6))
        self.normal.append(normal)
        return len(self.place) - 1

    def wall_heights(self, depth: float, count: int) -> np.ndarray:
        """Random heights, clear of the bottom and of the top edge."""
        return -depth * self.rng.uniform(0.12, 0.9, count)

    def touch(self, **row) -> None:
        """One moment in the clamping of now."""
        self.contacts.add(**row, set_up=int(self.writer.set_up == "G55"))

    def approach(self, xy: np.ndarray, depth: float, feed: float) -> None:
        self.writer.rapid_to(xy[0], xy[1])
        self.writer.rapid_to(z=3.0)
        self.writer.line_to(z=-depth, feed=feed / 2)

    # --- features: centre (2,), each draws its own sizes -------------------------------------

    def bore(self, name: str, centre: np.ndarray, feed: float) -> None:
        """Circular pocket, roughed with an allowance and finished, either way round."""
        rng, tool = self.rng, self.writer.tool
        radius, depth = rng.uniform(20, 42), float(rng.choice([6.0, 12.0, 20.0, 30.0]))
        turn, allowance = int(rng.choice([-1, 1])), float(rng.choice([0.2, 0.4, 0.8]))
        for left in (allowance, 0.0):
            rho = round(radius - tool.diameter_mm / 2 - left, 4)
            self.approach(centre, depth, feed)
            self.writer.line_to(x=centre[0] + rho, feed=feed)
            start = self.writer.arc_to(
                (centre[0] + rho, centre[1]), tuple(centre), turn=turn, feed=feed
            )
            self.writer.line_to(x=centre[0], feed=2 * feed)
            self.writer.rapid_to(z=20.0)
        radius = rho + tool.diameter_mm / 2
        angles = np.deg2rad(np.linspace(8, 352, 36) + rng.uniform(-3, 3, 36))
        for angle, z in zip(angles, self.wall_heights(depth, 36), strict=True):
            out = np.array([np.cos(angle), np.sin(angle), 0.0])
            turned = (turn * angle) % (2 * np.pi) / (2 * np.pi)
            self._on_arc(
                name,
                np.array([*centre, 0.0]),
                out,
                z=z,
                depth=depth,
                rho=rho,
                edge=radius,
                nodes=start,
                turn=turn,
                turned=turned,
                feed=feed,
                # the last of the turn meets what the tool took away where it began
                ae=allowance if turned < 0.5 else _left_by_entry(radius, rho, angle, allowance),
            )

    def _on_arc(
        self, name, centre, out, *, z, depth, rho, edge, nodes, turn, turned, feed, ae
    ) -> None:
        """A wall point at radius `edge` that a tool going round at radius `rho` leaves."""
        speed = feed / 60
        tangent = turn * np.array([-out[1], out[0], 0.0])
        side = -1.0 if edge > rho else 1.0  # outward normal of the material
        point = self.point(name, centre + edge * out + [0, 0, z], side * out)
        along = nodes[0] + turned * (nodes[1] - nodes[0])
        self.touch(
            point=point,
            tip_mm=centre + rho * out + [0, 0, -depth],
            velocity_mm_s=speed * tangent,
            acceleration_mm_s2=-(speed**2) / rho * out,
            node=min(int(along), nodes[1] - 1),
            share=along - min(int(along), nodes[1] - 1),
            tool=self.writer.tool.number - 1,
            ae_mm=ae,
            ap_mm=depth,
        )

    def boss(self, name: str, centre: np.ndarray, feed: float, *, turned: float = 0.0) -> None:
        """Square post milled round its outside, either way, walls overrun at the corners."""
        rng, tool = self.rng, self.writer.tool
        half, depth = rng.uniform(18, 26), float(rng.choice([6.0, 12.0, 20.0, 30.0]))
        ways, allowance = int(rng.choice([-1, 1])), float(rng.choice([0.2, 0.4, 0.8]))
        angles = turned + ways * np.arange(4) * np.pi / 2
        for left in (allowance, 0.0):
            reach = tool.diameter_mm / 2 + left
            walls, first = [], True
            for angle in angles:
                out = np.array([np.cos(angle), np.sin(angle)])
                tangent = ways * np.array([-out[1], out[0]])
                length = half + tool.diameter_mm / 2 + OVERRUN_MM
                begin = centre + (half + reach) * out - length * tangent
                if first:
                    self.approach(begin, depth, feed)
                    first = False
                else:
                    self.writer.line_to(*begin, feed=feed)
                end = begin + 2 * length * tangent
                walls.append((out, tangent, length, self.writer.line_to(*end, feed=feed)))
            self.writer.rapid_to(z=20.0)
        for number, (out, tangent, length, node) in enumerate(walls):
            for s, z in zip(
                np.linspace(-0.85, 0.85, 12) * half, self.wall_heights(depth, 12), strict=True
            ):
                place = np.array([*(centre + half * out + s * tangent), z])
                point = self.point(f"{name}.w{number}", place, np.array([*out, 0.0]))
                self.touch(
                    point=point,
                    tip_mm=np.array(
                        [*(centre + (half + tool.diameter_mm / 2) * out + s * tangent), -depth]
                    ),
                    velocity_mm_s=feed / 60 * np.array([*tangent, 0.0]),
                    node=node,
                    share=(s + length) / (2 * length),
                    tool=tool.number - 1,
                    ae_mm=allowance,
                    ap_mm=depth,
                )

    def diamond(self, name: str, centre: np.ndarray, feed: float) -> None:
        """A post turned by any angle."""
        self.boss(name, centre, feed, turned=float(self.rng.uniform(0.2, np.pi / 2 - 0.2)))

    def pocket(self, name: str, centre: np.ndarray, feed: float) -> None:
        """Square pocket; its walls are measured closely behind each corner."""
        rng, tool = self.rng, self.writer.tool
        reach, depth = rng.uniform(18, 28), float(rng.choice([6.0, 12.0, 20.0]))
        ways, allowance = int(rng.choice([-1, 1])), float(rng.choice([0.2, 0.4, 0.8]))
        out = [np.array([np.cos(a), np.sin(a)]) for a in ways * np.arange(4) * np.pi / 2]
        for left in (allowance, 0.0):
            half, nodes = reach - left, []
            self.approach(centre, depth, feed)
            self.writer.line_to(*(centre + half * out[0]), feed=feed)
            for k in range(4):  # from the middle of a wall over its end to the next one's
                nodes.append(
                    self.writer.line_to(*(centre + half * (out[k] + out[k - 3])), feed=feed)
                )
            self.writer.line_to(*(centre + half * out[0]), feed=feed)
            self.writer.line_to(*centre, feed=2 * feed)
            self.writer.rapid_to(z=20.0)
        for k in range(1, 4):
            tangent, length = out[k - 3], 2 * reach
            way = np.array([0.15, 0.4, 0.8, 1.4, 2.2, 3.5, 6.0, 10.0, 16.0, 24.0, 30.0])
            for s, z in zip(way, self.wall_heights(depth, len(way)), strict=True):
                tip = centre + reach * (out[k] - tangent) + s * tangent
                place = np.array([*(tip + tool.diameter_mm / 2 * out[k]), z])
                point = self.point(f"{name}.w{k}", place, np.array([*-out[k], 0.0]))
                self.touch(
                    point=point,
                    tip_mm=np.array([*tip, -depth]),
                    velocity_mm_s=feed / 60 * np.array([*tangent, 0.0]),
                    node=nodes[k],
                    share=s / length,
                    tool=tool.number - 1,
                    ae_mm=allowance,
                    ap_mm=depth,
                )

    def groove(self, name: str, centre: np.ndarray, feed: float) -> None:
        """Two straight grooves along X or Y, the floor measured along the middle."""
        rng, tool = self.rng, self.writer.tool
        axis, depth = int(rng.integers(2)), float(rng.choice([2.0, 4.0, 8.0]))
        along = np.eye(2)[axis]
        across, way = np.eye(2)[1 - axis], float(rng.choice([-1, 1]))
        both = float(rng.choice([-1, 1]))
        for number, offset in enumerate((-17.0, 17.0)):
            direction = way * along * (both if number else 1.0)
            begin = centre + offset * across - 45.0 * direction
            self.approach(begin, depth, feed)
            node = self.writer.line_to(*(begin + 90.0 * direction), feed=feed)
            self.writer.rapid_to(z=20.0)
            for s in np.linspace(6, 84, 18):
                place = np.array([*(begin + s * direction), -depth])
                point = self.point(name, place, np.array([0.0, 0.0, 1.0]))
                # on the way, and at rest where the way begins and ends
                reach = np.array(FLOOR_SHARES) * tool.diameter_mm / 2
                moments = [(at, feed / 60) for at in np.clip(s + reach, 0, 90)]
                moments += [(at, 0.0) for at in (0.0, 90.0) if abs(at - s) <= reach[-1]]
                for at, speed in moments:
                    self.touch(
                        point=point,
                        tip_mm=np.array([*(begin + at * direction), -depth]),
                        velocity_mm_s=speed * np.array([*direction, 0.0]),
                        node=node,
                        share=at / 90.0,
                        tool=tool.number - 1,
                        ae_mm=tool.diameter_mm,
                        ap_mm=depth,
                    )

    def wave(self, name: str, centre: np.ndarray, feed: float) -> None:
        """Slot of two tangent arcs, one pass at full width, both walls measured."""
        rng, tool = self.rng, self.writer.tool
        rho, angle, depth = rng.uniform(32, 45), np.deg2rad(65), float(rng.choice([6.0, 12.0]))
        first_turn, phi = int(rng.choice([-1, 1])), float(rng.uniform(0, 2 * np.pi))
        start = centre  # the middle of the S; both arms turn about points beside it
        toward = np.array([np.cos(phi), np.sin(phi)])
        hub = start + rho * toward
        other = start - rho * toward
        begin = hub + _turned(start - hub, -first_turn * angle)
        self.approach(begin, depth, feed)
        for number, (hub_xy, turn) in enumerate(((hub, first_turn), (other, -first_turn))):
            hub_xy = np.round(hub_xy, 4)
            here = self.writer.tip_mm[:2]
            end = start if number == 0 else other + _turned(start - other, turn * angle)
            nodes = self.writer.arc_to(tuple(end), tuple(hub_xy), turn=turn, feed=feed)
            true_rho = np.hypot(*(here - hub_xy))
            a0 = np.arctan2(*(here - hub_xy)[::-1])
            for wall, sign in (("L", 1.0), ("R", -1.0)):
                for share, z in zip(
                    np.linspace(0.12, 0.88, 14), self.wall_heights(depth, 14), strict=True
                ):
                    a = a0 + turn * share * angle
                    self._on_arc(
                        f"{name}.{wall}",
                        np.array([*hub_xy, 0.0]),
                        np.array([np.cos(a), np.sin(a), 0.0]),
                        z=z,
                        depth=depth,
                        rho=true_rho,
                        edge=true_rho - sign * turn * tool.diameter_mm / 2,
                        nodes=nodes,
                        turn=turn,
                        turned=share,
                        feed=feed,
                        ae=tool.diameter_mm,
                    )
        self.writer.rapid_to(z=20.0)

    def spline(self, name: str, centre: np.ndarray, feed: float) -> None:
        """Sine-shaped slot in short chords, one pass at full width, both walls measured."""
        rng, tool = self.rng, self.writer.tool
        depth, phi = float(rng.choice([6.0, 12.0, 20.0])), float(rng.uniform(0, 2 * np.pi))
        height, length = rng.uniform(5, 8), 90.0
        cos, sin = np.cos(phi), np.sin(phi)
        frame = np.array([[cos, -sin], [sin, cos]])

        def curve(u):
            return centre + np.array([u, height * np.sin(2 * np.pi * u / length)]) @ frame.T

        chords = np.round([curve(u) for u in np.linspace(-45, 45, 226)], 4)
        self.approach(chords[0], depth, feed)
        nodes = [self.writer.line_to(*xy, feed=feed) for xy in chords[1:]]
        self.writer.rapid_to(z=20.0)
        for wall, sign in (("L", 1.0), ("R", -1.0)):
            for u, z in zip(np.linspace(-38, 38, 26), self.wall_heights(depth, 26), strict=True):
                slope = 2 * np.pi / length * height * np.cos(2 * np.pi * u / length)
                left = sign * np.array([-slope, 1.0]) / np.hypot(1, slope) @ frame.T
                place = curve(u) + tool.diameter_mm / 2 * left
                index, share, distance = _nearest(chords, place)
                at = chords[index] + share * (chords[index + 1] - chords[index])
                point = self.point(f"{name}.{wall}", np.array([*place, z]), np.array([*-left, 0.0]))
                way = chords[index + 1] - chords[index]
                self.touch(
                    point=point,
                    tip_mm=np.array([*at, -depth]),
                    velocity_mm_s=feed / 60 * np.array([*way, 0.0]) / np.hypot(*way),
                    node=nodes[index],
                    share=share,
                    tool=tool.number - 1,
                    ae_mm=tool.diameter_mm,
                    ap_mm=depth,
                    geometry_mm=distance - tool.diameter_mm / 2,
                )


def _left_by_entry(radius: float, rho: float, angle: float, allowance: float) -> float:
    """Material on a bore's wall at an angle, where the tool came in along X to `rho`, in mm."""
    inwards = np.linspace(0.0, allowance, 401)
    x, y = (radius - inwards) * np.cos(angle), (radius - inwards) * np.sin(angle)
    gone = np.hypot(x - np.clip(x, 0.0, rho), y) < radius - rho
    return float(inwards[np.argmax(gone)]) if gone.any() else allowance


def _turned(vector: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def _nearest(chords: np.ndarray, place: np.ndarray) -> tuple[int, float, float]:
    """Chord, share along it and distance of the nearest point of a polyline."""
    way = np.diff(chords, axis=0)
    share = np.einsum("ij,ij->i", place - chords[:-1], way) / np.einsum("ij,ij->i", way, way)
    share = np.clip(share, 0, 1)
    distance = np.hypot(*(chords[:-1] + share[:, None] * way - place).T)
    best = int(np.argmin(distance))
    return best, float(share[best]), float(distance[best])
