"""The closed loop: plant, sensors and flight software flown cycle by cycle, how a flight ends, and
checkpoints of it.
"""
