"""Attitude control: from attitude error to demanded torque. ``registry`` lists the family of controllers."""
