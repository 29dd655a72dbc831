# shellcheck shell=bash
# Sourced by tools/setup.sh and tests/matrix.sh.

# upstream_source PACKAGE TMP OPTION...: unpack the upstream archive of a Debian source package (NAME or NAME/SUITE), without
# Debian's patches, into TMP/tree. The options are apt's. apt checks the checksum. Fails with apt's words in TMP/log.
upstream_source() {
  local package=$1 tmp=$2 uri file sum
  shift 2
  apt-get "$@" source --print-uris "$package" >"$tmp/uris" 2>"$tmp/log" || return 1
  if ! read -r uri file _ sum < <(grep '\.orig\.tar' "$tmp/uris"); then
    echo "E: no upstream archive of $package" >"$tmp/log"
    return 1
  fi
  uri=${uri#\'}
  /usr/lib/apt/apt-helper "$@" download-file "${uri%\'}" "$tmp/$file" "$sum" >"$tmp/log" 2>&1 || return 1
  # most of the size is examples and potentials
  mkdir -p "$tmp/unpacked"
  tar -xf "$tmp/$file" -C "$tmp/unpacked" --no-same-owner --exclude='examples/*' --exclude='potentials/*' \
    --exclude='bench/*' --exclude='unittest/*' --exclude='doc/src/*'
  # with or without a folder around it
  local found=("$tmp"/unpacked/cmake "$tmp"/unpacked/*/cmake)
  [[ -d ${found[0]} ]] || found=("${found[@]:1}")
  mv -T "$(dirname "${found[0]}")" "$tmp/tree"
}
