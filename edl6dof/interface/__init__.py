"""Interface of plant and flight software: records, names and capacities on which both must agree."""
