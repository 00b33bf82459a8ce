"""Where to land: the ground as the eyes show it, what of it is safe, and the spot that is chosen.

Coarse, at the start of powered descent, from an image of hazard density; fine, in hover, from a map of
elevations.
"""
