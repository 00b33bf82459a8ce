"""Reports: what they say and show (``document``, ``figure``), and who writes them down: ``page`` with
``plotly_figure`` as HTML to look into, ``pdf`` with ``matplotlib_figure`` for papers.
"""
