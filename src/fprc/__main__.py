"""``python -m fprc``: the command ``fprc`` of this Python."""

import sys

from fprc.cli import main

sys.exit(main())
