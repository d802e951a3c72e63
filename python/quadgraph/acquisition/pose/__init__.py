"""Where a body lies, told by masks: outlines, the fit nearby, and the search all around."""
