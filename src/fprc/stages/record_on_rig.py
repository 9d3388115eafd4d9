"""Run an experiment of the workflow on the real rig."""

from fprc.apparatus.record import record_on_rig

__all__ = ["record_on_rig"]
