"""Capacities of the records: fixed, as compiled code demands."""

from __future__ import annotations

#: Thrusters of a vehicle.
MAX_THRUSTERS = 32
#: Propellant branches, each behind one latch valve.
MAX_BRANCHES = MAX_THRUSTERS
#: Parts of a vehicle that can be jettisoned; the flight software has a row for each subset of them.
MAX_PARTS = 8
#: Engines, and deployable surfaces, of a vehicle.
MAX_ENGINES = 8
MAX_SURFACES = 4
#: Propellant tanks of a vehicle.
MAX_TANKS = 4
#: Footpads of a landing gear, as many points of the underside, and all of these that may meet the ground.
MAX_FOOTPADS = 8
MAX_CONTACTS = 2 * MAX_FOOTPADS
#: Parachutes of a vehicle.
MAX_PARACHUTES = 4
#: Gyros, and accelerometers, of an inertial unit; beams of a landing radar; ports of an air data system.
MAX_GYROS = 8
MAX_ACCELEROMETERS = 8
MAX_BEAMS = 8
#: Star trackers, which are compared with each other.
MAX_TRACKERS = 2
MAX_PORTS = 8
#: Phases of a mission.
MAX_PHASES = 16
#: Events of a mission, and those of one phase.
MAX_EVENTS = 24
MAX_PHASE_EVENTS = 8
#: Transitions of a phase, and conditions of one.
MAX_TRANSITIONS = 4
MAX_CONDITIONS = 4
#: Faults of a flight.
MAX_FAULTS = 16
#: Rows and columns of a scan of the lidar, and rows that it shoots in one base cycle.
SCAN_ROWS = SCAN_COLUMNS = 256
SCAN_BLOCK = 4
#: Cells of a pair of stereo images, and of an image of the landing camera, along each side.
STEREO_CELLS = 128
CAMERA_CELLS = 64
#: Landmarks of the map that are sought in an image, along each side of a square and in all.
LANDMARK_ROWS = 6
MAX_LANDMARKS = LANDMARK_ROWS * LANDMARK_ROWS
