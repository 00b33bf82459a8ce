"""Motion of the plant: its equations, the steps over them, and the events that cut a step."""
