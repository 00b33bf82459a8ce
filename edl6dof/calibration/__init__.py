"""Calibration: the uncertain parameters of a scenario that best explain what is published of its flight."""
