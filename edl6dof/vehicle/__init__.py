"""The vehicle as it really is: mass, aerodynamics, actuators, parachutes, landing gear, faults, and the
motion that follows from them.
"""
