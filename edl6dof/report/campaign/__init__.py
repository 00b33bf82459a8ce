"""The report of a campaign: landing points, margins to the limits, and the inputs that drive them."""
