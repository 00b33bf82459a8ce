"""Estimators: what the flight software infers about the world beyond navigation."""
