"""Reports: what they say and show (``document``, ``figure``), and who writes them down (``page`` in HTML,
``paper`` by matplotlib).
"""
