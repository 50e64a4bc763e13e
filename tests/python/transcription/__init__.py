"""Units' equations written a second time, in the papers' frames and in Python, to compare the units with."""
