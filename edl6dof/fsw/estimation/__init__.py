"""Estimators: disturbance force and torque, loss of engine thrust, and a stuck throttle."""
