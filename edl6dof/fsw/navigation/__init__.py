"""Navigation: from instrument readings to the state that mission logic, guidance and control use.

The readings of redundant gyros and accelerometers become one motion of the body (:mod:`.redundancy`), which
is integrated (:mod:`.strapdown`); a filter corrects the solution with star tracker, radar and ground tracking
(:mod:`.filters`); angles, speeds and heights follow from it (:mod:`.derived`).
"""
