"""Reports: their content (``document``, ``figure``) and its forms: ``page`` with ``plotly_figure`` for the
screen, ``pdf`` with ``matplotlib_figure`` for paper.
"""
