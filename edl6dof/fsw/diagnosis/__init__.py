"""Diagnosis of thruster faults from the force and torque that the commands do not explain."""
