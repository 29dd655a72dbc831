#!/bin/bash
# SAGA's Export Surfer Grid writes a cell without data as the number that its own grid has for it, -9999. The format,
# Surfer's binary grid (DSBB), has one mark for such cells, 1.70141e38, and no place to name another; SAGA writes that
# if its option "Use Surfer's No-Data Value" is set, which it is not. The header still says that the heights are 100 to
# 111: whatever reads the file has pits 10 km deep along the border, which count in a volume.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"

# SAGA of Debian 12 with the libraries that it needs, unpacked, not installed
mkdir -p lists/partial debs/partial root && : >status
# shellcheck disable=SC2016 # apt expands these
mirror=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' |
  sed -n '/security/d; s/^Debian //p' | head -n 1)
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm main" >sources.list
apt=(-qq -o Dir::Etc::SourceList="$tmp/sources.list" -o Dir::Etc::SourceParts=/dev/null
     -o Dir::State::Lists="$tmp/lists" -o Dir::State::status="$tmp/status" -o Dir::Cache="$tmp"
     -o Dir::Cache::Archives="$tmp/debs" -o Debug::NoLocking=1)
version=8.5.0+dfsg-2
{ apt-get "${apt[@]}" update && apt-get "${apt[@]}" -d -y --no-install-recommends install saga=$version
} >apt.log 2>&1 || { echo "Debian's saga $version cannot be had" >&2; exit 77; }
for deb in debs/*.deb; do dpkg-deb -x "$deb" root; done
lib=$tmp/root/usr/lib/x86_64-linux-gnu libc=$tmp/root/lib/x86_64-linux-gnu
mkdir tools && ln -s "$lib"/saga/libio_grid.so tools
saga() {
  SAGA_TLB=$tmp/tools "$libc/ld-linux-x86-64.so.2" --library-path "$lib:$libc:$lib/blas:$lib/lapack" \
    "$tmp/root/usr/bin/saga_cmd" --flags=s --cores=1 "$@" >>saga.log 2>&1 || { cat saga.log >&2; exit 1; }
}

printf 'ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999
100 101 102 103\n104 -9999 106 107\n108 109 110 111\n' >ground.asc
saga io_grid 1 -FILE ground.asc -GRID ground.sgrd
seen=
for mark in default:"" chosen:"-NODATA 1"; do
  # shellcheck disable=SC2086 # none or one option
  saga io_grid 2 -GRID ground.sgrd -FILE ground.grd ${mark#*:}
  # header: DSBB, two short integers, six doubles (the last two of which are the least and the greatest height)
  seen+="${mark%:*}: header $(od -An -t f8 -j 40 -N 16 ground.grd | xargs), "
  seen+="middle $(od -An -t f4 -j 76 -N 4 ground.grd | xargs); "
done
expected='default: header 100 111, middle -9999; chosen: header 100 111, middle 1.70141e+38; '

echo "software:     SAGA $version of Debian 12"
echo "a good guess: 1.70141e+38, the only mark of this format, in both"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
