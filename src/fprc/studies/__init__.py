"""The studies behind the paper: the fit of the rig, families of rigs, models beyond the paper's.

Nothing of the paper imports them.
"""
