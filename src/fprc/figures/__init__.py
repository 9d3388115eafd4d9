"""Figures: functions that draw arrays into axes, independent of rig and models."""
