"""`python -m pluto_bt` is `pluto`."""

import sys

from pluto_bt.cli import main

sys.exit(main())
