"""`python -m voldetail.cli` is the same as `voldetail`."""

import sys

from voldetail.cli.main import main

sys.exit(main())
