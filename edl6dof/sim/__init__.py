"""From a scenario to a flight: records, the loop, telemetry, results."""
