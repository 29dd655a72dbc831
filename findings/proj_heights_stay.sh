#!/bin/bash
# Heights above the sea become heights above the ellipsoid by the grid of a geoid. Debian's PROJ has that of EGM96, but
# not those of EGM2008 and of Japan's JGD2011 (EPSG:6697). Without its grid a height comes back as it was, 42 m too low
# in the middle of Japan, with no error and no warning, also if pyproj is told to check for errors; the accuracy that it
# gives is "unknown" in each case, with the grid and without.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"

# pyproj of Debian 12 with the libraries that it needs, unpacked, not installed
mkdir -p lists/partial debs/partial root && : >status
# shellcheck disable=SC2016 # apt expands these
mirror=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' |
  sed -n '/security/d; s/^Debian //p' | head -n 1)
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm main" >sources.list
apt=(-qq -o Dir::Etc::SourceList="$tmp/sources.list" -o Dir::Etc::SourceParts=/dev/null
     -o Dir::State::Lists="$tmp/lists" -o Dir::State::status="$tmp/status" -o Dir::Cache="$tmp"
     -o Dir::Cache::Archives="$tmp/debs" -o Debug::NoLocking=1)
version=3.4.1-1+b1
{ apt-get "${apt[@]}" update && apt-get "${apt[@]}" -d -y --no-install-recommends install python3-pyproj=$version
} >apt.log 2>&1 || { echo "Debian's python3-pyproj $version cannot be had" >&2; exit 77; }
for deb in debs/*.deb; do dpkg-deb -x "$deb" root; done
usr=$tmp/root/usr lib=$tmp/root/usr/lib/x86_64-linux-gnu libc=$tmp/root/lib/x86_64-linux-gnu
cat >look.py <<'PYTHON'
import warnings

from pyproj import Transformer, proj_version_str

with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    print("PROJ", proj_version_str, end=":")
    for name, system in (("EGM96", "EPSG:4326+5773"), ("EGM2008", "EPSG:4326+3855"), ("JGD2011", "EPSG:6697")):
        change = Transformer.from_crs(system, "EPSG:4979", always_xy=True)
        height = change.transform(138, 36, 100, errcheck=True)[2]
        print(f" {name} {height:.1f} m (accuracy {change.accuracy:g});", end="")
    print("", len(caught), "warnings")
PYTHON
export PYTHONHOME=$usr PROJ_LIB=$usr/share/proj
seen=$("$libc/ld-linux-x86-64.so.2" --library-path "$lib:$libc:$lib/blas:$lib/lapack" "$usr/bin/python3.11" look.py \
  2>look.log) || { cat look.log >&2; exit 1; }
expected='PROJ 9.1.1: EGM96 142.3 m (accuracy -1); EGM2008 100.0 m (accuracy -1); '
expected+='JGD2011 100.0 m (accuracy -1); 0 warnings'

echo "software:     pyproj $version and proj-data of Debian 12"
echo "a good guess: some 142 m in each, or an error where there is no grid"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
