"""The ground around the landing site, down to a tenth of a metre: fractal relief, craters and rocks.

It is the bilinear surface over a lattice of heights.  The height of a node follows from its place and the key
of the case alone, so it needs no memory, has no edge, and does not depend on the order of queries.
"""
