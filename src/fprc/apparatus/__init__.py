"""Processes that drive and supervise the real rig."""
