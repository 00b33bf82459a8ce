"""What crosses between plant and flight software, and nothing else: records, names and capacities on which
both must agree.
"""
