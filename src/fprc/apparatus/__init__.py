"""The processes that drive and watch the real rig."""
