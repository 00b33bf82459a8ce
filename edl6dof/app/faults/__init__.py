"""``edl6dof faults``: the matrix of single faults."""
