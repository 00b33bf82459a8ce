"""A point mass under a powered law: what the law is given, and how the mass moves."""

import numpy as np

from edl6dof.config.units import G0
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS, powered_guidance
from edl6dof.fsw.guidance.powered.target import POWERED_TARGET, choose_target
from edl6dof.fsw.guidance.powered.terminal_descent import command_thrust, start_or_throttle
from edl6dof.fsw.hazard.site_selection import LANDING_POINT
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.vehicle_state import VEHICLE_STATE

#: Nothing chosen by hazard detection.
NO_POINT = np.zeros(1, LANDING_POINT)[0]
G = 3.72
MASS = 940.0


class PointMass:
    """Position north, east, height; velocity north, east, down; the guidance sees it as navigation."""

    def __init__(self, height, velocity_N, east=0.0, north=0.0):
        self.nav, self.out = np.zeros(1, NAV)[0], np.zeros(1, GUIDE)[0]
        self.nav["gravity"] = G
        self.t, self.r, self.v = 0.0, np.array([north, east, height], float), np.array(velocity_N, float)
        self.see()

    def see(self):
        self.nav["t"], self.nav["height"], self.nav["v_N"] = self.t, self.r[2], self.v
        self.nav["site_L"] = self.r[1], self.r[0], self.r[2]
        self.nav["speed"] = np.linalg.norm(self.v)

    def move(self, north, east, up, dt):
        """``up`` includes what gravity takes away."""
        a = np.array([north, east, G - up])
        self.r = self.r + (self.v * dt + 0.5 * a * dt * dt) * (1.0, 1.0, -1.0)
        self.v = self.v + a * dt
        self.t += dt
        self.see()


class Guided:
    """A powered law with its memory, and the target that is chosen where it begins."""

    def __init__(self, record, law, body):
        self.settings, self.vehicle = record["guidance"]["powered"], record["vehicle"]
        self.law, self.memory = POWERED_LAWS.names.index(law), np.zeros(1, POWERED_LAWS.memory)[0]
        self.state, self.target = np.zeros(1, VEHICLE_STATE)[0], np.zeros(1, POWERED_TARGET)[0]
        self.state["ignited"], self.state["mass"] = 1, MASS
        self.state["engine"] = self.vehicle["engines"][0]
        choose_target(self.settings["target"], body.nav, NO_POINT, self.target)

    @property
    def goal(self):
        """North, east, height."""
        east, north = self.target["point_L"]
        return np.array([north, east, self.target["height"]])

    def __call__(self, body):
        """Acceleration north, east, up, and tilt limit."""
        return powered_guidance(
            *(self.law, self.settings, self.vehicle, self.state),
            *(body.nav, self.target, self.memory, body.out),
        )

    def burn(self, thrust, dt):
        """Take the propellant of a thrust (N) off the mass."""
        self.state["mass"] -= thrust / (G0 * self.state["engine"]["specific_impulse"]) * dt


def fly_on_the_engine(record, law, body, dt=0.1, longest=70.0):
    """Fly a law to the end of its time with the engine that the vehicle has; thrust (N) by time."""
    guided, powered, thrust = Guided(record, law, body), record["guidance"]["powered"], []
    body.out["engine_mode"] = 2  # as at ignition
    while body.t < longest:
        *acceleration, limit = guided(body)
        if body.t > 5.0 and body.out["time_to_go"] < 0.5:
            break
        command_thrust(guided.state["mass"], tuple(acceleration), limit, body.out)
        start_or_throttle(
            guided.state["engine"], False, powered["full_time"], powered["full_again"], body.t, body.out
        )
        force = body.out["thrust"] * body.out["thrust_direction_N"] / guided.state["mass"]
        thrust.append((body.t, float(body.out["thrust"])))
        body.move(force[0], force[1], -force[2], dt)
        guided.burn(body.out["thrust"], dt)
    return guided, np.array(thrust)
