"""The disturbance estimators, one in each file."""
