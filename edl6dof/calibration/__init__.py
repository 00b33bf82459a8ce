"""Calibration: the uncertain parameters of a scenario that best explain the published flight."""
