"""Contents of the 3D scene of a replay: vehicle, parachute, flames, ground, planet, paths."""
