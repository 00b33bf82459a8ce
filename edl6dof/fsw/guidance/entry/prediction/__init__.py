"""What the flight computer expects of the entry: its models of vehicle and drag, and trajectories predicted
with them.
"""
