#!/bin/bash
# LIGGGHTS takes a terrain of STL triangles in national coordinates as it is and computes in double precision. What it
# dumps has six digits: in UTM the northings of balls, and of the terrain itself (mesh/stl), are rounded to 10 m. The
# triangle here, 8 m wide, comes back as a line under a facet normal that is still right.
# shellcheck source-path=SCRIPTDIR source=debian.bash
source "$(dirname "${BASH_SOURCE[0]}")/debian.bash"

unpack liggghts 3.8.0+repack1-9+b2

cat >ground.stl <<'STL'
solid ground
facet normal 0 0 1
outer loop
vertex 382100.125 3950096.5 120.25
vertex 382108.375 3950096.5 120.25
vertex 382100.125 3950104.5 122.25
endloop
endfacet
endsolid ground
STL
cat >in.dump <<'DECK'
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
region box block 382090 382140 3950090 3950140 100 150 units box
create_box 1 box
neighbor 0.1 bin
neigh_modify delay 0
fix 1 all property/global youngsModulus peratomtype 1e8
fix 2 all property/global poissonsRatio peratomtype 0.3
fix 3 all property/global coefficientRestitution peratomtypepair 1 0.3
fix 4 all property/global coefficientFriction peratomtypepair 1 0.6
pair_style gran model hertz tangential history
pair_coeff * *
create_atoms 1 single 382123.456 3950123.456 123.456
set atom 1 diameter 1 density 2000
fix 5 all mesh/surface file ground.stl type 1
fix 6 all nve/sphere
timestep 1e-5
dump 1 all custom 1 ball.dump x y z
dump 2 all mesh/stl 1 mesh*.stl
run 0
write_data ball.data
DECK
OPAL_PREFIX=$usr OMPI_MCA_btl=self OMPI_MCA_ess_singleton_isolated=1 run liggghts -in in.dump >run.log 2>&1 || {
  cat run.log >&2; exit 1; }
seen="ball $(awk '/^Atoms/ { getline; getline; printf "%.3f", $6 }' ball.data) in the data, "
seen+="$(tail -n 1 ball.dump | awk '{ print $2 }') in the dump; "
seen+="vertices $(awk '/vertex/ { print $3 }' mesh*.stl | xargs), normal $(awk '/normal/ { print $4, $5 }' mesh*.stl)"
expected='ball 3950123.456 in the data, 3.95012e+06 in the dump; '
expected+='vertices 3.9501e+06 3.9501e+06 3.9501e+06, normal -0.242536 0.970143'

echo "software:     LIGGGHTS-PUBLIC, $version of Debian 12"
echo "a good guess: the ball at 3950123.456 m north in both, the vertices at 3950096.5, 3950096.5 and 3950104.5"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
