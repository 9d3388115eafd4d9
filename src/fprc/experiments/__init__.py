"""What the paper does, in memory: experiments, comparison, grids, closed loops."""
