"""The planet: gravity, atmosphere, wind and ground, each one parameter model, one record and one kernel."""
