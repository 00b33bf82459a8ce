"""Differences between the temperature profiles that ship, and the winds of the one that has winds.

    python tools/air_profiles.py

Missions that fly a profile of another place and season disperse their temperatures and winds by these numbers
(scenarios/*_mc.yaml; docs/air.md).
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from edl6dof.environment.atmosphere_table import Profile, profile_path, read_profile

#: Profiles of different places and seasons.
PROFILES = {
    "Jezero, Ls 5.5 deg": "marsgram2010_jezero_feb2021_winds.csv",
    "northern summer": "mars_cospar_nh_mean.csv",
    "Phoenix, late spring": "phoenix_tes_limb.csv",
}
#: Heights (m) at which a capsule decelerates.
HEIGHTS = np.arange(5e3, 45.1e3, 1e3)
GAS_CONSTANT = 191.0  # J/(kg K); converts pressures, which are not used here


def profile(name: str) -> Profile:
    """Read a profile that ships."""
    return read_profile(name, profile_path(name).read_bytes(), GAS_CONSTANT)


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def main() -> None:
    """Print the differences of each two profiles, and the size of the winds."""
    known = {place: profile(name) for place, name in PROFILES.items()}
    temperatures = {place: np.interp(HEIGHTS, one.altitude, one.temperature) for place, one in known.items()}
    means, others = [], []
    print("temperature, 5 to 45 km, K                       mean  standard deviation")
    for first, second in combinations(known, 2):
        difference = temperatures[first] - temperatures[second]
        means.append(difference.mean())
        others.append(difference.std())
        print(f"{first + ' less ' + second:46} {means[-1]:6.1f}  {others[-1]:5.1f}")
    print(f"{'root mean square':46} {rms(np.array(means)):6.1f}  {rms(np.array(others)):5.1f}")
    windy = known["Jezero, Ls 5.5 deg"]
    for name, wind in (("east", windy.east), ("north", windy.north)):
        size = rms(np.interp(HEIGHTS, windy.altitude, wind))
        per_km = size / HEIGHTS.mean() * 1e3
        words = f"{size:.0f} m/s; {per_km:.2f} m/s per km of the mean height"
        print(f"wind towards {name}, root mean square: {words}")


if __name__ == "__main__":
    main()
