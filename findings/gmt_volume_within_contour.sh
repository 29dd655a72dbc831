#!/bin/bash
# The volume of a deposit's grid: GMT's grdvolume counts whole cells if it has no contour. With one, which one adds to
# leave out the ground around (-C0, or -C0.1 for what is thicker than 10 cm), it joins the middles of cells, and half a
# cell is lost all along a rim beyond which there is no value: 14 % of a deposit of 20 x 10 cells that is 1 m thick. A
# contour of 0.1 also takes 10 cm off the thickness of all the rest, unless -L0 is given.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"

# GMT of Debian 12 with all that it needs, unpacked, not installed
mkdir -p lists/partial debs/partial root && : >status
# shellcheck disable=SC2016 # apt expands these
mirror=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' |
  sed -n '/security/d; s/^Debian //p' | head -n 1)
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm main" >sources.list
apt=(-qq -o Dir::Etc::SourceList="$tmp/sources.list" -o Dir::Etc::SourceParts=/dev/null
     -o Dir::State::Lists="$tmp/lists" -o Dir::State::status="$tmp/status" -o Dir::Cache="$tmp"
     -o Dir::Cache::Archives="$tmp/debs" -o Debug::NoLocking=1)
version=6.4.0+dfsg-2
{ apt-get "${apt[@]}" update && apt-get "${apt[@]}" -d -y --no-install-recommends install gmt=$version
} >apt.log 2>&1 || { echo "Debian's gmt $version cannot be had" >&2; exit 77; }
for deb in debs/*.deb; do dpkg-deb -x "$deb" root; done
lib=$tmp/root/usr/lib/x86_64-linux-gnu libc=$tmp/root/lib/x86_64-linux-gnu
gmt() {
  GMT_SHAREDIR=$tmp/root/usr/share/gmt "$libc/ld-linux-x86-64.so.2" --library-path "$lib:$libc:$lib/blas:$lib/lapack" \
    "$tmp/root/usr/bin/gmt" "$@"
}

# 24 x 14 cells of 5 m, values in 20 x 10 of them
{ printf 'ncols 24\nnrows 14\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n'
  awk 'BEGIN { for (j = 0; j < 14; j++) for (i = 0; i < 24; i++)
    print (i > 1 && i < 22 && j > 1 && j < 12) ? 1 : -9999 }'
} >deposit.asc
seen=
for contour in "" -C0 -C0.1 "-C0.1 -L0"; do
  # shellcheck disable=SC2086 # none, one or two options
  seen+="${contour:-no contour}: $(gmt grdvolume deposit.asc=ei $contour 2>>gmt.log |
    awk '{ printf "%.0f m2, %.0f m3; ", $2, $3 }')"
done
expected='no contour: 5000 m2, 5000 m3; -C0: 4275 m2, 4275 m3; -C0.1: 4275 m2, 3847 m3; -C0.1 -L0: 4275 m2, 4275 m3; '

echo "software:     GMT $(gmt --version), of Debian 12"
echo "a good guess: 5000 m2, 5000 m3 in each case (200 cells of 25 m2, 1 m thick)"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
