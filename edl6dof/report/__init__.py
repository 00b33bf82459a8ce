"""Reports: content (``document``, ``figure``), web page (``page``) and paper (``pdf``)."""
