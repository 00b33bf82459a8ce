"""Landing engines and reaction-control thrusters, and the tanks that they draw from."""
