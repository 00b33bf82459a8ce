"""Parachutes: the canopy as a body of its own, the bridle that carries the vehicle, the models of filling."""
