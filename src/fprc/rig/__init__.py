"""The simulated rig: physics only, no files, no configuration, no clock.

Pressures are gauge, in kPa, unless a name ends in ``_abs``. Torques are divided by the
actuator's ratio of torque to pressure and so have the unit kPa. Angles are in deg, volumes in mL,
flows in mL/s of air at atmospheric pressure (ANR).
"""
