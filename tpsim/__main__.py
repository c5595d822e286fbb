"""``python -m tpsim``: the command line."""

import sys

from tpsim.cli.main import main

sys.exit(main())
