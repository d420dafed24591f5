"""``python -m guidance_app`` is the command ``guidance-app``."""

import sys

from guidance_app.cli import main

if __name__ == "__main__":
    sys.exit(main())
