"""Vehicle models of other programs: DAVE-ML files, read safely."""
