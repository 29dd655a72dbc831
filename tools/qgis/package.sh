#!/bin/bash
# The plugin as a zip, for QGIS' "Install from ZIP": tools/qgis/package.sh [slope.zip]
set -euo pipefail

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
zip="$(realpath -m "${1:-slope.zip}")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

mkdir "$folder/slope"
cp "$here"/slope/*.py "$here"/slope/metadata.txt "$folder/slope/"
"$here/describe.py" > "$folder/slope/commands.json"
(cd "$folder" && /usr/bin/python3 - "$zip" <<'PYTHON'
import pathlib
import sys
import zipfile

with zipfile.ZipFile(sys.argv[1], "w", zipfile.ZIP_DEFLATED) as packed:
    for path in sorted(pathlib.Path("slope").iterdir()):
        packed.write(path)
PYTHON
)
echo "$zip: QGIS, Plugins > Manage and Install Plugins > Install from ZIP"
