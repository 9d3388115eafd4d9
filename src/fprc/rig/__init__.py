"""The simulated rig: physics only, no files, no configuration, no clock.

Pressures are gauge [kPa] unless a name ends in ``_abs``. Torques are divided
by the pressure-to-torque gain of the actuator and so read in kPa; angles are
in deg, volumes in mL, flows in mL/s of air at the atmosphere (ANR).
"""
