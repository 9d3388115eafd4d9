"""Figures: functions that draw arrays into axes, independent of rig and models."""

from pathlib import Path

#: Folder of the paper's figures that show no data: fixed files, PDF and PNG (300 dpi). The code
#: from which they were drawn, but for some labels, is in the history, at commit d4274ff3.
DRAWINGS = Path(__file__).with_name("drawings")
