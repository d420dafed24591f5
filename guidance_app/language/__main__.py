"""``python -m guidance_app.language``: brings the catalogues up to the code and says what is left to translate."""

import sys

from guidance_app.language.catalogues import TRANSLATED, catalogue_path, faults_of, read_catalogue, template, updated


def main() -> int:
    """0 when nothing is left to do."""
    wanted = template()
    left = 0
    for language in TRANSLATED:
        path = catalogue_path(language)
        path.write_bytes(updated(path.read_bytes(), language, wanted))
        faults = faults_of(read_catalogue(language), wanted)
        left += len(faults)
        sys.stdout.writelines(f"{path.name}: {fault}\n" for fault in faults)
    sys.stdout.write(f"{len(wanted)} messages, {left} left to do\n")
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
