"""Entry guidance laws: the bank angle that brings the vehicle to the parachute target."""
