"""Navigation: from what the instruments read to the state that mission logic, guidance and control use.

Readings of redundant gyros and accelerometers become one motion of the body (:mod:`.redundancy`), that is
integrated (:mod:`.strapdown`), a filter corrects the solution by what star tracker, radar and ground tracking
say (:mod:`.filters`), and angles, speeds and heights follow from it (:mod:`.derived`).
"""
