"""The vehicle as it really is: mass, aerodynamics, actuators, parachute, landing gear, equations of
motion.
"""
