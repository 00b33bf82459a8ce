"""Draw the figure of frames, angles, signs and heights.

    python tools/docs_conventions.py FILE

The kernels of ``edl6dof.spatial.frames`` give the directions of the body axes.
"""

from __future__ import annotations

import sys
from math import cos, radians, sin
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Arc, Circle

from edl6dof.spatial.frames import attitude_from_wind_angles
from edl6dof.spatial.quaternion import axes

BODY, PATH, WORLD, MARK = "#1f5fbf", "#c2410c", "#3f3f46", "#15803d"
#: Flight to the north, in north-east-down components.
NORTH, UP = (1.0, 0.0, 0.0), (0.0, 0.0, -1.0)


def body_axes(bank: float, alpha: float, beta: float) -> np.ndarray:
    """Axes x, y, z of B (rows; north, east, down) in level flight to the north at angles in degrees."""
    return np.array(axes(attitude_from_wind_angles(NORTH, UP, *np.radians((bank, alpha, beta)))))


def arrow(ax: Any, start: Any, along: Any, label: str, colour: str, *, dashed: bool = False) -> None:
    """Draw an arrow from ``start``, with its label beyond the tip."""
    start, along = np.asarray(start, float), np.asarray(along, float)
    style = {"arrowstyle": "-|>", "color": colour, "lw": 1.6, "linestyle": "--" if dashed else "-"}
    ax.annotate("", start + along, start, arrowprops={**style, "shrinkA": 0, "shrinkB": 0})
    tip = start + along * (1.0 + 0.13 / max(np.hypot(*along), 1e-9))
    ax.text(*tip, label, color=colour, ha="center", va="center", fontsize=10)


def turn(ax: Any, centre: Any, radius: float, first: float, last: float, label: str) -> None:
    """Draw the arc of an angle with an arrow head at ``last`` (degrees from the right, counterclockwise)."""
    low, high = min(first, last), max(first, last)
    ax.add_patch(Arc(centre, 2 * radius, 2 * radius, theta1=low, theta2=high, color=MARK, lw=1.6))
    end, way = radians(last), 1.0 if last > first else -1.0
    tip = np.add(centre, radius * np.array([cos(end), sin(end)]))
    back = tip - 0.02 * way * np.array([-sin(end), cos(end)])
    ax.annotate("", tip, back, arrowprops={"arrowstyle": "-|>", "color": MARK, "lw": 1.6})
    middle = radians(0.5 * (first + last))
    ax.text(*np.add(centre, (radius + 0.17) * np.array([cos(middle), sin(middle)])), label, color=MARK,
            ha="center", va="center", fontsize=11)  # fmt: skip


def angle_of(v: Any) -> float:
    """Direction of a plane vector, degrees from the right, counterclockwise."""
    return float(np.degrees(np.arctan2(v[1], v[0])))


def capsule(ax: Any, nose: Any, side: Any) -> None:
    """Draw a blunt capsule, with ``nose`` and ``side`` as the pictures of x and of the axis across."""
    along = np.array([0.12, 0.07, -0.08, -0.14, -0.50, -0.50, -0.14, -0.08, 0.07, 0.12])
    across = np.array([0.0, 0.14, 0.42, 0.42, 0.16, -0.16, -0.42, -0.42, -0.14, 0.0])
    points = np.outer(along, nose) + np.outer(across, side)
    ax.fill(*points.T, facecolor="#dbeafe", edgecolor=BODY, lw=1.0, zorder=0)


def show_planet(ax: Any) -> None:
    """Frames I, F, N and L on the planet."""
    view = np.array([[-sin(0.5), cos(0.5), 0.0], [-0.42 * cos(0.5), -0.42 * sin(0.5), 0.91]])
    ax.add_patch(Circle((0, 0), 0.8, facecolor="#fde8d8", edgecolor=WORLD, lw=1.0, zorder=0))
    equator = np.radians(np.arange(0, 361, 4))
    ax.plot(
        *(0.8 * view @ np.array([np.cos(equator), np.sin(equator), 0 * equator])), color="#d6b8a4", lw=0.8
    )
    spin = radians(35.0)
    pole = view @ (0, 0, 1.25)
    arrow(ax, (0, 0), pole, "$z_I = z_F$", WORLD)
    arrow(ax, (0, 0), view @ (1.2, 0, 0), "$x_I$", WORLD)
    arrow(ax, (0, 0), view @ (1.2 * cos(spin), 1.2 * sin(spin), 0), "$x_F$", WORLD, dashed=True)
    ax.text(
        *(view @ (0.95 * cos(spin / 2), 0.95 * sin(spin / 2), 0.0)), r"$\Omega t$", color=MARK, fontsize=10
    )
    for lat, lon, names, size in (
        (48, 95, ("north", "east", "down"), 0.42),
        (-22, 72, ("east", "north", "up"), 0.34),
    ):
        a, b = np.radians((lat, lon))
        out = np.array([cos(a) * cos(b), cos(a) * sin(b), sin(a)])
        ways = {"up": out, "down": -out, "east": np.array([-sin(b), cos(b), 0.0])}
        ways["north"] = np.cross(out, ways["east"])
        place = view @ ((1.04 if size > 0.4 else 0.8) * out)
        for name in names:
            arrow(ax, place, size * view @ ways[name], name, PATH if size > 0.4 else MARK)
    ax.text(1.12, 0.95, "N at the vehicle", color=PATH, ha="center", fontsize=9)
    ax.text(0.95, -1.1, "L at the landing site", color=MARK, ha="center", fontsize=9)
    limits(ax, "Frames I, F, N, L")


def show_alpha(ax: Any) -> None:
    """Angle of attack, seen from the right: north to the right of the picture, down below."""
    x, _, z = body_axes(0.0, 25.0, 0.0)[:, [0, 2]] * (1.0, -1.0)
    capsule(ax, x, z)
    arrow(ax, (0, 0), 1.1 * x, "$x_B$", BODY)
    arrow(ax, (0, 0), 0.8 * z, "$z_B$", BODY)
    arrow(ax, (0, 0), (0.95, 0.0), "$V$, $x_V$", PATH)
    arrow(ax, (0, 0), (0.0, -0.95), "$z_V$", PATH)
    turn(ax, (0, 0), 0.75, 0.0, angle_of(x), r"$\alpha>0$")
    ax.text(
        0.0, -1.3, r"$y_B$ towards the reader; $\alpha=\mathrm{atan2}(w,u)$, nose up", ha="center", fontsize=9
    )
    limits(ax, "Angle of attack, from the right")


def show_beta(ax: Any) -> None:
    """Sideslip, seen from above: north up, east to the right."""
    x, y, _ = body_axes(0.0, 0.0, 25.0)[:, [1, 0]]
    capsule(ax, x, y)
    arrow(ax, (0, 0), 1.1 * x, "$x_B$", BODY)
    arrow(ax, (0, 0), 0.85 * y, "$y_B$", BODY)
    arrow(ax, (0, 0), (0.0, 1.15), "$V$", PATH)
    turn(ax, (0, 0), 0.75, angle_of(x), 90.0, r"$\beta>0$")
    ax.text(0.0, -1.3, r"$z_B$ into the page; $\beta=\arcsin(v/V)$, nose left", ha="center", fontsize=9)
    limits(ax, "Sideslip, from above")


def show_bank(ax: Any) -> None:
    """Bank, seen from behind: east to the right, down below."""
    _, y, z = body_axes(35.0, 0.0, 0.0)[:, [1, 2]] * (1.0, -1.0)
    ax.add_patch(Circle((0, 0), 0.42, facecolor="#dbeafe", edgecolor=BODY, lw=1.0, zorder=0))
    arrow(ax, (0, 0), y, "$y_B$", BODY)
    arrow(ax, (0, 0), 0.9 * z, "$z_B$", BODY)
    arrow(ax, (0, 0), -1.0 * z, "lift", PATH)
    ax.plot((-1.1, 1.1), (0, 0), color=WORLD, lw=0.8, ls=":")
    arrow(ax, (0, 0), (0.0, 1.1), "up", WORLD, dashed=True)
    turn(ax, (0, 0), 0.75, 90.0, angle_of(-z), r"$\sigma>0$")
    ax.text(0.0, -1.3, "$V$ into the page; right wing down, lift to the right", ha="center", fontsize=9)
    limits(ax, r"Bank $\sigma$, from behind")


def show_crossrange(ax: Any) -> None:
    """Range, downrange and crossrange to the aim point, seen from above."""
    aim = np.array([-0.6, 1.0])
    arrow(ax, (0, -0.9), (0.0, 1.65), "course", PATH)
    ax.plot(*aim, marker="x", color=MARK, ms=9, mew=2)
    ax.text(aim[0] - 0.05, aim[1] + 0.14, "aim point", color=MARK, ha="center", fontsize=10)
    ax.plot((0, aim[0]), (-0.9, aim[1]), color=WORLD, lw=1.0, ls=":")
    ax.text(-0.62, -0.05, "range_to_go", color=WORLD, ha="center", fontsize=9)
    ax.annotate("", aim, (0.0, aim[1]), arrowprops={"arrowstyle": "<->", "color": MARK, "lw": 1.4})
    ax.text(0.06, aim[1] + 0.07, "crossrange > 0", color=MARK, fontsize=9)
    ax.annotate("", (0.22, aim[1]), (0.22, -0.9), arrowprops={"arrowstyle": "<->", "color": MARK, "lw": 1.4})
    ax.text(0.3, 0.0, "downrange_to_go", color=MARK, fontsize=9)
    ax.text(
        0.0, -1.3, "positive crossrange: the course passes right of the aim point", ha="center", fontsize=9
    )
    limits(ax, "Range to the aim point, from above")


def show_lander(ax: Any) -> None:
    """Frames B and C and the tilt of a lander, seen from the side."""
    tilt = radians(32.0)
    thrust = np.array([sin(tilt), cos(tilt)])
    across = np.array([cos(tilt), -sin(tilt)])
    body = np.array([(-0.3, 0.0), (-0.42, -0.32), (-0.28, -0.32), (-0.2, -0.05)])
    outline = np.array([*body, *(body[::-1] * (-1, 1)), (0.3, 0.0), (0.3, 0.22), (-0.3, 0.22)])
    ax.fill(*(np.outer(outline[:, 0], across) + np.outer(outline[:, 1], thrust)).T, facecolor="#dbeafe",
            edgecolor=BODY, zorder=0)  # fmt: skip
    arrow(ax, (0, 0), -0.95 * thrust, "$x_B$", BODY)
    arrow(ax, (0, 0), 1.0 * thrust, "$x_C$, thrust", BODY)
    arrow(ax, (0, 0), (0.0, 1.0), "up", WORLD, dashed=True)
    turn(ax, (0, 0), 0.72, 90.0, angle_of(thrust), "tilt")
    ax.text(0.0, -1.3, "$x_C=-x_B$, $y_C=y_B$, $z_C=-z_B$; landed: $x_B$ down", ha="center", fontsize=9)
    limits(ax, "Lander: B and C")


def show_roll(ax: Any) -> None:
    """Roll error of a lander, seen from above: north up, east to the right."""
    error = radians(50.0)
    y = np.array([sin(error), -cos(error)])
    ax.add_patch(Circle((0, 0), 0.42, facecolor="#dbeafe", edgecolor=BODY, lw=1.0, zorder=0))
    arrow(ax, (0, 0), 0.95 * y, "$y_B$", BODY)
    arrow(ax, (0, 0), (0.0, -1.0), "south = goal of $y_B$", PATH)
    arrow(ax, (0, 0), (0.0, 0.95), "north", WORLD, dashed=True)
    arrow(ax, (0, 0), (0.95, 0.0), "east", WORLD, dashed=True)
    turn(ax, (0, 0), 0.68, angle_of(y), -90.0, "")
    ax.text(0.42, -0.85, "error > 0", color=MARK, fontsize=10)
    ax.text(0.0, -1.3, "$x_B$ into the page: a positive torque turns clockwise", ha="center", fontsize=9)
    limits(ax, "Roll error, from above")


def show_heights(ax: Any) -> None:
    """Heights above ellipsoid, areoid and ground."""
    s = np.linspace(-1.3, 1.3, 60)
    ground = 0.02 + 0.22 * np.exp(-((s - 0.1) ** 2) / 0.25) + 0.03 * np.sin(9 * s)
    ax.fill_between(s, ground, -1.2, color="#f3d9c5", zorder=0)
    for level, name in ((-0.95, "ellipsoid"), (-0.5, "areoid")):
        ax.plot(s, level + 0 * s, color=WORLD, lw=1.0, ls="--")
        ax.text(1.25, level + 0.07, name, color=WORLD, ha="right", fontsize=9)
    ax.plot(0.1, 1.0, marker="v", color=BODY, ms=10)
    top = float(np.interp(0.1, s, ground))
    for at, low, high, name in (
        (-1.0, -0.95, 1.0, "altitude"),
        (-0.5, -0.5, 1.0, "height above areoid"),
        (0.1, top, 0.95, "height"),
        (0.6, -0.5, float(np.interp(0.6, s, ground)), "elevation"),
    ):
        ax.annotate("", (at, high), (at, low), arrowprops={"arrowstyle": "<->", "color": MARK, "lw": 1.4})
        ax.text(at + 0.06, 0.5 * (low + high), name, color=MARK, fontsize=9, rotation=90, va="center")
    ax.plot((-1.05, 0.1), (1.0, 1.0), color=WORLD, lw=0.7, ls=":")
    ax.text(0.0, -1.3, "air and ground count from the areoid", ha="center", fontsize=9)
    limits(ax, "Heights")


def limits(ax: Any, title: str) -> None:
    """Set the same scale and no axes."""
    ax.set(xlim=(-1.4, 1.4), ylim=(-1.4, 1.4), aspect="equal", title=title)
    ax.axis("off")


def main() -> None:
    """Draw the figure."""
    figure, panels = plt.subplots(2, 4, figsize=(15, 7.8), layout="constrained")
    entry = (show_planet, show_alpha, show_beta, show_bank)
    landing = (show_crossrange, show_lander, show_roll, show_heights)
    for show, ax in zip((*entry, *landing), panels.flat, strict=True):
        show(ax)
    figure.savefig(sys.argv[1], dpi=100)


if __name__ == "__main__":
    main()
