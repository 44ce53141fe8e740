"""``python -m contactsnes`` is the command ``contactsnes``."""

import sys

from .cli import main

sys.exit(main())
