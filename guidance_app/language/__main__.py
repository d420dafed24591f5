"""``python -m guidance_app.language``: brings the catalogues up to the code and says what is left to translate."""

import sys

from guidance_app.language.catalogues import bring_up

if __name__ == "__main__":
    LEFT = bring_up()
    sys.stdout.writelines(f"{line}\n" for line in LEFT)
    sys.exit(1 if LEFT else 0)
