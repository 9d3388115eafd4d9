"""The paper's experiments, comparison, grids and closed loops, all in memory."""
