"""Direction of the flow from the pressures at ports of the heat shield.

Behind a strong shock the pressure at a port with the outward normal n is p = p_inf + (n . g)^2, where g has
the direction of the flow that comes towards the ports, and g^2 = q Cp_max. Least squares by Gauss-Newton give
g; neither the density nor the pressure coefficient has to be known. The static pressure p_inf is believed: an
error of 30 % changes the shown angle by 10 % at Mach 1.7, and by 3 % at Mach 3.

Source: Karlgaard et al., Journal of Spacecraft and Rockets 51(4), 2014 (modified Newtonian pressures, least
squares over all ports); the derivative: this project.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel
from edl6dof.spatial.vector import add, cross, dot, scale, unit

STEPS = 2  # Gauss-Newton steps from the predicted direction
SPECIFIC_HEATS = 1.3  # their ratio in CO2; with 1.4 the shown angle is 2 % smaller at Mach 1.7


@kernel
def static_pressure(dynamic_pressure, mach):
    """Pressure (Pa) of the air far ahead."""
    return 2.0 * dynamic_pressure / (SPECIFIC_HEATS * mach * mach)


@kernel
def flow_at_ports(instruments, pressure, static, ahead):
    """Measure the flow with the ports.

    Args:
        instruments: ``INSTRUMENTS`` record.
        pressure: readings, Pa.
        static: believed pressure of the air far ahead, Pa.
        ahead: predicted direction of the velocity in air (3, B), of any length.

    Returns:
        Its components along y and z over that along x; their variance for a port error of 1 Pa, 1/Pa2; the
        largest pressure, Pa. Zeros if no port reads more than the static pressure.
    """
    most = static
    for i in range(instruments.n_ports):
        most = max(most, pressure[i])
    if most <= static:
        return (0.0, 0.0), (0.0, 0.0), 0.0
    g = scale(sqrt(most - static), unit(ahead))
    variance = (0.0, 0.0)
    for _ in range(STEPS):
        x, y, z, rest = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for i in range(instruments.n_ports):
            axis = instruments.port_axis[i]
            n = (axis[0], axis[1], axis[2])
            facing = dot(n, g)
            row = scale(2.0 * facing, n)
            x, y, z = add(x, scale(row[0], row)), add(y, scale(row[1], row)), add(z, scale(row[2], row))
            rest = add(rest, scale(pressure[i] - static - facing * facing, row))
        # inverse of the normal matrix with the rows x, y, z: columns y x z, z x x, x x y over the determinant
        first, second, third = cross(y, z), cross(z, x), cross(x, y)
        share = 1.0 / dot(x, first)
        change = add(add(scale(rest[0], first), scale(rest[1], second)), scale(rest[2], third))
        g = add(g, scale(share, change))
        variance = (share * second[1] / (g[0] * g[0]), share * third[2] / (g[0] * g[0]))
    return (g[1] / g[0], g[2] / g[0]), variance, most
