"""A second implementation of the units' equations in Python and in the frames of the papers, for comparison."""
